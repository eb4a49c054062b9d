#include "lodeline/batch/batch_landmarks.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

namespace lodeline {
namespace {

/// Landmarks per group: few enough to share most of their states, and small compared with the whole problem.
constexpr size_t kStretch = 16;
/// Groups whose systems are in memory at one time.
constexpr size_t kAtOnce = 64;

}  // namespace

void BatchLandmarks::arrange() {
  stretches_.clear();
  for (auto& [id, track] : window_.tracks()) {
    if (!track.landmark) continue;
    if (stretches_.empty() || stretches_.back().tracks.size() == kStretch) stretches_.emplace_back();
    stretches_.back().tracks.push_back(&track);
  }
}

double BatchLandmarks::cost() const {
  std::vector<double> costs(stretches_.size(), 0.0);
  tbb::parallel_for(size_t{0}, stretches_.size(), [&](size_t i) {
    std::vector<double> residual;
    for (FeatureTrack* track : stretches_[i].tracks) {
      for (const Factor& factor : factors_.landmark(window_, *track).factors)
        costs[i] += costOf(factor, residual);
    }
  });
  return std::accumulate(costs.begin(), costs.end(), 0.0);
}

void BatchLandmarks::linearize(const std::function<void(const NormalEquations&)>& take) {
  for (size_t begin = 0; begin < stretches_.size(); begin += kAtOnce) {
    const size_t end = std::min(begin + kAtOnce, stretches_.size());
    tbb::parallel_for(begin, end, [&](size_t i) {
      NormalEquations system;
      for (FeatureTrack* track : stretches_[i].tracks)
        system.addEliminated(factors_.landmark(window_, *track));
      stretches_[i].system = std::move(system);
    });
    for (size_t i = begin; i < end; ++i) {
      take(stretches_[i].system);
      stretches_[i].system.forgetTerms();
    }
  }
}

void BatchLandmarks::step(const std::function<Eigen::VectorXd(const NormalEquations&)>& stepOf) const {
  tbb::parallel_for(size_t{0}, stretches_.size(), [&](size_t i) {
    const NormalEquations& system = stretches_[i].system;
    system.stepLandmarks(stepOf(system));
  });
}

}  // namespace lodeline

#include "lodeline/mapping/session/loops/candidate_search.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

constexpr double kSigmas = 3.0;
// Standard deviation of the difference of two depths by pressure, m, beside their own: weather and tide.
constexpr double kDepthSigma_m = 0.15;
// A prediction wider than this, m, leaves the choice to appearance.
constexpr double kWide_m = 5.0;

/// Whether two depths differ by more than `reach_m` and their errors.
bool areApart(const std::optional<ScalarPrior>& a, const std::optional<ScalarPrior>& b, double reach_m) {
  if (!a || !b) return false;
  const double sigma_m = std::hypot(kDepthSigma_m, a->sigma, b->sigma);
  return std::abs(a->value - b->value) > reach_m + kSigmas * sigma_m;
}

double clampedExcess(double value, double limit) { return std::max(0.0, value - limit); }

}  // namespace

void CandidateSearchOptions::check() const {
  if (!(least_path_m > 0.0)) throw UsageError("the least path of a loop must be positive");
  if (!(view_distance_m > 0.0)) throw UsageError("the viewing distance of a loop must be positive");
  if (!(view_angle_rad > 0.0)) throw UsageError("the viewing angle of a loop must be positive");
  if (most_candidates < 1) throw UsageError("at least one candidate for a loop is needed");
}

CandidateSearch::CandidateSearch(const CandidateSearchOptions& options) : options_(options) {
  options_.check();
}

bool CandidateSearch::isPossible(const KnownKeyframe& old_keyframe, const KnownKeyframe& newest,
                                 const LoopPrediction& prediction) const {
  const Vec3& apart_m = prediction.old_from_new.translation;
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(prediction.covariance.topLeftCorner<3, 3>());
  const Vec3 along = axes.eigenvectors().transpose() * apart_m;
  const double excess =
      clampedExcess(apart_m.norm(), options_.view_distance_m) / std::max(1e-9, apart_m.norm());
  double squared = 0.0;
  for (int i = 0; i < 3; ++i)
    squared += std::pow(excess * along[i], 2) / std::max(axes.eigenvalues()[i], 1e-6);
  if (squared > kSigmas * kSigmas) return false;
  const Vec3 view_in_old = prediction.old_from_new.rotation * newest.view_B;
  const double angle_rad = std::acos(std::clamp(view_in_old.dot(old_keyframe.view_B), -1.0, 1.0));
  const double sigma_rad = std::sqrt(prediction.covariance.bottomRightCorner<3, 3>().trace());
  return angle_rad < options_.view_angle_rad + kSigmas * sigma_rad;
}

std::vector<LoopCandidateKeyframe> CandidateSearch::find(const MapKeyframe& newest,
                                                         const KnownKeyframes& known,
                                                         const DescriptorIndex& index) const {
  const KnownKeyframe& now = known.at(newest.id);
  // The odometry since any earlier keyframe is at most this uncertain; it bounds the search cheaply.
  const Mat6 drift = known.between(known.firstOf(now.dive), now.id).covariance;
  const double drift_m = kSigmas * std::sqrt(drift.topLeftCorner<3, 3>().trace());
  std::map<KeyframeId, LoopCandidateKeyframe> possible;
  for (const KnownKeyframe& old_keyframe : known.all()) {
    const bool same_dive = old_keyframe.dive == now.dive;
    if (same_dive && now.path_m - old_keyframe.path_m < options_.least_path_m) continue;
    if (old_keyframe.id == now.id) continue;
    if (areApart(now.depth_m, old_keyframe.depth_m, options_.view_distance_m)) continue;
    const double apart_m = (now.map_from_body.translation - old_keyframe.map_from_body.translation).norm();
    if (same_dive && apart_m > options_.view_distance_m + drift_m) continue;
    LoopCandidateKeyframe candidate{old_keyframe.id, known.predict(old_keyframe.id, now.id)};
    if (candidate.prediction) {
      if (!isPossible(old_keyframe, now, *candidate.prediction)) continue;
      const double sigma_m = std::sqrt(candidate.prediction->covariance.topLeftCorner<3, 3>().trace());
      candidate.is_wide = kSigmas * sigma_m > kWide_m;
    }
    possible.emplace(candidate.id, candidate);
  }
  std::vector<LoopCandidateKeyframe> chosen;
  if (possible.empty()) return chosen;
  const auto isExcluded = [&](KeyframeId id) { return possible.count(id) == 0; };
  for (const SimilarKeyframe& similar : index.query(newest, options_.most_candidates, isExcluded))
    chosen.push_back(possible.at(similar.id));
  return chosen;
}

}  // namespace lodeline

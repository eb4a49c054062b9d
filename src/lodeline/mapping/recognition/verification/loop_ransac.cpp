#include "lodeline/mapping/recognition/verification/loop_ransac.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "lodeline/mapping/recognition/verification/upright_two_point.h"

namespace lodeline {
namespace {

/// Samples at most: enough for one of inliers alone among 1 in 12, with a probability of 99 %.
constexpr int kMostSamples = 700;

/// Draws samples and solves them.
class Sampler {
 public:
  Sampler(const std::vector<LoopCorrespondence>& pairs, const std::vector<bool>& is_used,
          const MapKeyframe& old_keyframe, const MapKeyframe& new_keyframe)
      : pairs_(pairs),
        old_level_(old_keyframe.odom_from_body.rotation),
        new_level_(new_keyframe.odom_from_body.rotation) {
    for (size_t i = 0; i < pairs.size(); ++i) {
      if (!is_used[i]) continue;
      if (pairs[i].in_old.has_point) points_old_.push_back(i);
      if (pairs[i].in_new.has_point) points_new_.push_back(i);
    }
  }

  bool isPossible() const { return points_old_.size() > 1 || points_new_.size() > 1; }

  /// Poses old_from_new of the next sample.
  std::vector<Rigid3> draw() {
    // Samples from either set, as often as the set has pairs of pairs.
    const size_t weight_old = points_old_.size() * points_old_.size();
    const size_t weight_new = points_new_.size() * points_new_.size();
    const bool is_old = below(weight_old + weight_new) < weight_old;
    const std::vector<size_t>& set = is_old ? points_old_ : points_new_;
    if (set.size() < 2) return {};
    const size_t a = below(set.size());
    size_t b = below(set.size() - 1);
    if (b >= a) ++b;
    std::vector<Rigid3> poses = posesOfTwoPoints(sample(set[a], is_old), sample(set[b], is_old));
    for (Rigid3& pose : poses) {
      if (is_old) pose = pose.inverse();
      pose = {(old_level_.conjugate() * pose.rotation * new_level_).normalized(),
              old_level_.conjugate() * pose.translation};
    }
    return poses;
  }

 private:
  /// std::uniform_int_distribution depends on the library; the bias of the remainder is below 1e-12.
  size_t below(size_t count) { return random_() % std::max<size_t>(1, count); }

  /// In axes with z up at the origin of each body. Where the points are old, the frame T of the rays is the
  /// new one.
  PointOnRay sample(size_t index, bool is_old) const {
    const LoopCorrespondence& pair = pairs_[index];
    const PointObservation& seen = is_old ? pair.in_old : pair.in_new;
    const PointObservation& ray = is_old ? pair.in_new : pair.in_old;
    const Quat& point_level = is_old ? old_level_ : new_level_;
    const Quat& ray_level = is_old ? new_level_ : old_level_;
    return {point_level * seen.point_B, ray_level * ray.origin_B, ray_level * ray.bearing_B};
  }

  const std::vector<LoopCorrespondence>& pairs_;
  Quat old_level_, new_level_;
  std::vector<size_t> points_old_, points_new_;
  std::mt19937_64 random_{58};
};

/// Sum of the squared residuals over their gates, each at most 1. Stops beyond `limit`.
double costOf(const std::vector<LoopCorrespondence>& pairs, const std::vector<bool>& is_used,
              const Rigid3& pose, double limit) {
  double cost = 0.0;
  for (size_t i = 0; i < pairs.size() && cost < limit; ++i) {
    if (!is_used[i]) continue;
    const LoopResidual residual = residualOf(pairs[i], pose, false);
    cost += residual.is_valid ? std::min(1.0, residual.squared() / gateOf(residual.rows)) : 1.0;
  }
  return cost;
}

/// Samples until one of inliers alone has been drawn with a probability of 99.9 %, three times over, because
/// noise makes some of them useless.
int samplesFor(int inliers, int count) {
  const double share = std::clamp(static_cast<double>(inliers) / count, 1e-3, 0.95);
  const double samples = 3.0 * std::log(1e-3) / std::log1p(-share * share);
  return static_cast<int>(std::min<double>(kMostSamples, std::ceil(samples)));
}

}  // namespace

ConsensusPose consensusAt(const std::vector<LoopCorrespondence>& pairs, const std::vector<bool>& is_used,
                          const Rigid3& old_from_new) {
  ConsensusPose consensus{old_from_new, std::vector<bool>(pairs.size(), false), 0};
  for (size_t i = 0; i < pairs.size(); ++i) {
    if (!is_used[i] || !isInlier(residualOf(pairs[i], old_from_new, false))) continue;
    consensus.is_inlier[i] = true;
    ++consensus.inliers;
  }
  return consensus;
}

std::optional<ConsensusPose> findConsensus(const std::vector<LoopCorrespondence>& pairs,
                                           const std::vector<bool>& is_used, const MapKeyframe& old_keyframe,
                                           const MapKeyframe& new_keyframe) {
  constexpr int kLocalIterations = 4;
  constexpr int kLeastInliers = 3;
  constexpr int kLeastAccepted = 8;  // no pose with fewer inliers is ever accepted
  Sampler sampler(pairs, is_used, old_keyframe, new_keyframe);
  if (!sampler.isPossible()) return std::nullopt;
  const CommonVertical vertical(old_keyframe, new_keyframe);
  const int count = static_cast<int>(std::count(is_used.begin(), is_used.end(), true));
  std::optional<ConsensusPose> best;
  double best_cost = std::numeric_limits<double>::infinity();
  const auto offer = [&](const Rigid3& pose) {
    const double cost = costOf(pairs, is_used, pose, best_cost);
    if (cost >= best_cost) return false;
    ConsensusPose consensus = consensusAt(pairs, is_used, pose);
    if (consensus.inliers < kLeastInliers) return false;
    best = std::move(consensus);
    best_cost = cost;
    return true;
  };
  int samples = samplesFor(kLeastAccepted, count);
  for (int i = 0; i < samples; ++i) {
    for (const Rigid3& pose : sampler.draw()) {
      if (!offer(pose)) continue;
      const std::vector<bool> inliers = best->is_inlier;
      offer(refinePose(pairs, inliers, vertical, pose, kLocalIterations).old_from_new);
      samples = std::min(samples, samplesFor(best->inliers, count));
    }
  }
  return best;
}

}  // namespace lodeline

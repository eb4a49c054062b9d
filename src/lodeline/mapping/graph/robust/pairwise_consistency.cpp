#include "lodeline/mapping/graph/robust/pairwise_consistency.h"

#include <fmt/format.h>

#include "lodeline/diagnostics.h"
#include "lodeline/mapping/graph/robust/maximum_clique.h"
#include "lodeline/mapping/graph/robust/robust_weights.h"

namespace lodeline {
namespace {

RelativePose checkedPose(const Loop& loop) {
  const std::string what = fmt::format("loop of keyframes {} and {}", loop.old_keyframe, loop.new_keyframe);
  checkPose(loop.old_from_new, what.c_str());
  checkCovariance(loop.covariance, what.c_str());
  return {loop.old_from_new, loop.covariance};
}

}  // namespace

void ConsistencyOptions::check() const { chiSquaredQuantile(probability, 6); }

double circuitChiSquared(const Loop& a, const Loop& b, const OdometryBetween& odometry) {
  // Two ways from the old keyframe of a to the new keyframe of b.
  const RelativePose by_a = composed(checkedPose(a), odometry(a.new_keyframe, b.new_keyframe));
  const RelativePose by_b = composed(odometry(a.old_keyframe, b.old_keyframe), checkedPose(b));
  return mahalanobisSquared(by_a.from_from_to, by_b.from_from_to, by_a.covariance + by_b.covariance);
}

ConsistentLoops largestConsistentSet(const std::vector<Loop>& loops, const OdometryBetween& odometry,
                                     const ConsistencyOptions& options) {
  options.check();
  const double limit = chiSquaredQuantile(options.probability, 6);
  for (const Loop& loop : loops) checkedPose(loop);
  AdjacencyMatrix consistent(loops.size());
  for (size_t a = 0; a < loops.size(); ++a) {
    for (size_t b = a + 1; b < loops.size(); ++b) {
      if (circuitChiSquared(loops[a], loops[b], odometry) < limit) consistent.connect(a, b);
    }
  }
  const Clique clique = maximumClique(consistent);
  return {clique.vertices, clique.is_largest};
}

}  // namespace lodeline

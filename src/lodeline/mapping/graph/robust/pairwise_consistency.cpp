#include "lodeline/mapping/graph/robust/pairwise_consistency.h"

#include <fmt/format.h>

#include "lodeline/diagnostics.h"
#include "lodeline/mapping/graph/robust/maximum_clique.h"
#include "lodeline/mapping/graph/robust/robust_weights.h"

namespace lodeline {
namespace {

void check(const Loop& loop) {
  const std::string what = fmt::format("loop of keyframes {} and {}", loop.old_keyframe, loop.new_keyframe);
  checkPose(loop.old_from_new, what.c_str());
  checkCovariance(loop.covariance, what.c_str());
}

RelativePose poseOf(const Loop& loop) { return {loop.old_from_new, loop.covariance}; }

}  // namespace

void PairwiseConsistencyOptions::check() const { chiSquaredQuantile(probability, 6); }

Circuit circuitOf(const Loop& a, const Loop& b, const OdometryBetween& odometry) {
  const RelativePose by_a = composed(poseOf(a), odometry(a.new_keyframe, b.new_keyframe));
  const RelativePose by_b = composed(odometry(a.old_keyframe, b.old_keyframe), poseOf(b));
  return {by_a.from_from_to, by_b.from_from_to, by_a.covariance + by_b.covariance};
}

ConsistentLoops largestConsistentSet(const std::vector<Loop>& loops, const OdometryBetween& odometry,
                                     const PairwiseConsistencyOptions& options) {
  options.check();
  const double limit = chiSquaredQuantile(options.probability, 6);
  for (const Loop& loop : loops) check(loop);
  AdjacencyMatrix consistent(loops.size());
  for (size_t a = 0; a < loops.size(); ++a) {
    for (size_t b = a + 1; b < loops.size(); ++b) {
      if (circuitOf(loops[a], loops[b], odometry).chiSquared() < limit) consistent.connect(a, b);
    }
  }
  const Clique clique = maximumClique(consistent);
  return {clique.vertices, clique.is_largest};
}

}  // namespace lodeline

#pragma once

#include <cstddef>
#include <vector>

#include "lodeline/mapping/graph/motion/odometry_chains.h"
#include "lodeline/mapping/graph/robust/pairwise_consistency.h"

namespace lodeline {

/// Two neighbouring loops, as indices.
struct LoopPair {
  size_t a = 0, b = 0;
  bool agree = false;  ///< the chi^2 of their circuit is within the limit
};

/// Pairs of neighbouring loops: they join the same two chains, their ends lie within 25 keyframes of each
/// other, and the odometry between these is accurate enough to compare them. False loops seldom agree with a
/// neighbour; where a place was seen again, many agree. Pairs of two loops before `first_new` are left out.
/// `between_singles` gives the relative pose of two nodes that no chain has; `limit` is of chi^2.
std::vector<LoopPair> neighbouringLoops(const std::vector<Loop>& loops, size_t first_new,
                                        const OdometryChains& chains, const OdometryBetween& between_singles,
                                        double limit);

/// With how many neighbours a false loop agrees by accident, by the counts of refused loops.
class AccidentalAgreement {
 public:
  explicit AccidentalAgreement(std::vector<std::ptrdiff_t> counts_of_refused);

  /// Share of refused loops with which at least `count` others agree; 0 where none is refused.
  double share(std::ptrdiff_t count) const;

 private:
  std::vector<std::ptrdiff_t> counts_;  ///< ascending
};

}  // namespace lodeline

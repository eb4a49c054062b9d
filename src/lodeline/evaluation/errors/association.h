#pragma once

#include <cstddef>
#include <vector>

#include "lodeline/evaluation/trajectory/trajectory.h"

namespace lodeline {

enum class AssociationMethod {
  Nearest,      ///< the reference pose nearest in time
  Interpolate,  ///< the reference interpolated to the time of the estimate (linear position, slerp rotation)
};

struct AssociationOptions {
  AssociationMethod method = AssociationMethod::Nearest;
  /// Nearest: largest accepted difference of times. Interpolate: largest accepted distance to either
  /// neighbour.
  double tolerance_s = 0.01;
  /// Added to every time of the estimate.
  double time_offset_s = 0.0;
};

/// Poses of estimate and reference at the same instants, in the order of time; all vectors have equal size.
struct PosePairs {
  std::vector<Time> time;  ///< on the clock of the reference
  std::vector<Rigid3> estimate;
  std::vector<Rigid3> reference;

  std::size_t size() const { return time.size(); }
};

/// Pairs the poses of two trajectories in order of time. Two trajectories without times are paired by index.
/// By time, each pose is used at most once: of several that would share a partner the closest wins; the
/// trajectory with fewer poses chooses, so that a dense estimate against a sparse reference pairs once for
/// each reference pose. Throws InputError when only one has times, and when nothing matches (naming both
/// spans), and when tables without times differ in their number of rows.
PosePairs associate(const Trajectory& estimate, const Trajectory& reference,
                    const AssociationOptions& options);

}  // namespace lodeline

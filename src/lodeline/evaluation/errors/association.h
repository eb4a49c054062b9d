#pragma once

#include <cstddef>
#include <vector>

#include "lodeline/evaluation/trajectory/trajectory.h"

namespace lodeline {

enum class AssociationMethod {
  Nearest,      ///< the reference pose that is nearest in time
  Interpolate,  ///< the reference interpolated to the time of the estimate (linear position, slerp rotation)
};

struct AssociationOptions {
  AssociationMethod method = AssociationMethod::Nearest;
  /// Nearest: largest accepted time difference. Interpolate: largest accepted distance to either neighbour.
  double tolerance_s = 0.01;
  /// Added to every time of the estimate.
  double time_offset_s = 0.0;
};

/// Poses of estimate and reference at the same times, in order; all vectors have equal size.
struct PosePairs {
  std::vector<Time> time;  ///< on the clock of the reference
  std::vector<Rigid3> estimate;
  std::vector<Rigid3> reference;

  std::size_t size() const { return time.size(); }
};

/// Associates the poses of two trajectories in order of time. Two trajectories without times are associated
/// by index. By time, each pose is used at most once: of several with the same partner, the closest one is
/// used. The trajectory with fewer poses chooses, so that a dense estimate and a sparse reference give one
/// pair per reference pose. Throws InputError in these cases: only one trajectory has times, nothing matches
/// (the message names both spans), or tables without times differ in their number of rows.
PosePairs associate(const Trajectory& estimate, const Trajectory& reference,
                    const AssociationOptions& options);

}  // namespace lodeline

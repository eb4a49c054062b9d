#pragma once

#include <vector>

#include "lodeline/trajectory.h"

namespace lodeline {

/// A reading of the Earth's field, corrected for soft and hard iron.
struct StampedField {
  Time time;
  Vec3 field_B = Vec3::Zero();  ///< T, axes of the body
};

struct AzimuthCorrectionOptions {
  /// Azimuth of the field in the desired world, from its y axis (north) towards x (east): the declination
  /// where y is true north, zero where it is magnetic north.
  double field_azimuth_rad = 0.0;
  double window_s = 20.0;  ///< of the running median, centred on the pose
  double max_gap_s = 0.5;  ///< readings between poses further apart are skipped: their attitude is unknown
};

/// Loosely coupled baseline for the use of a magnetometer: corrects the heading of a finished visual-inertial
/// trajectory. The correction is the running median of the difference between two azimuths of the field: that
/// in the trajectory (levelled by the trajectory's own roll and pitch) and the desired one. Roll, pitch and
/// height do not change. The horizontal positions are summed again from the trajectory's steps, each rotated
/// by the mean correction of its ends. The first position stays. The median uses readings of half a window in
/// the future, so no causal filter could do the same.
///
/// `odometry` and `field` in order of time on one clock; z of the trajectory's world points up. A pose
/// without a reading in its window gets the correction of the pose before (at the start: of the first pose
/// with one). Throws InputError where no reading lies between two poses.
Trajectory correctHeadingByAzimuth(const Trajectory& odometry, const std::vector<StampedField>& field,
                                   const AzimuthCorrectionOptions& options);

}  // namespace lodeline

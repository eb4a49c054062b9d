#pragma once

#include <vector>

#include "lodeline/evaluation/trajectory/trajectory.h"

namespace lodeline {

/// A reading of the Earth's field, freed from soft and hard iron.
struct StampedField {
  Time time;
  Vec3 field_B = Vec3::Zero();  ///< T, axes of the body
};

struct AzimuthCorrectionOptions {
  /// Of the field in the wanted world, from its y axis (north) towards x (east): the declination where y is
  /// true north, zero where it is magnetic north.
  double field_azimuth_rad = 0.0;
  double window_s = 20.0;  ///< of the running median, centred on the pose
  double max_gap_s = 0.5;  ///< readings between poses further apart are left out: their attitude is unknown
};

/// The simplest use of a compass, which a tightly coupled one has to beat: the heading of a finished
/// visual-inertial trajectory is turned by the running median of the angle between the azimuth that the
/// field has in it (levelled by the trajectory's own roll and pitch) and the azimuth that it should have.
/// Roll, pitch and height stay; the horizontal way is added up anew from the trajectory's steps, each turned
/// by the mean correction of its ends. The first position stays. It looks ahead by half a window, so no
/// causal filter could do it.
///
/// `odometry` and `field` in order of time on one clock; z of the trajectory's world points up. A pose
/// without a reading in its window takes the correction of the pose before (at the start: of the first pose
/// that has one). Throws InputError where no reading lies between two poses.
Trajectory correctHeadingByAzimuth(const Trajectory& odometry, const std::vector<StampedField>& field,
                                   const AzimuthCorrectionOptions& options);

}  // namespace lodeline

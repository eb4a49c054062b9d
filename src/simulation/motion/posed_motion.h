#pragma once

#include <cstdint>

#include "simulation/shared/motion.h"

namespace lodeline {

/// Motion of a magnetometer calibration: the rig rotates about all its axes while the hands draw figures of
/// eight in the water. It rests for 4 s, then every direction of the sphere is reached within about 90 s.
Motion makeFigureEightMotion(uint64_t seed, double duration_s, const Rigid3& diver_from_body);

/// Motion of a rig at rest on a bench, tilted by a few degrees.
Motion makeMotionAtRest(uint64_t seed, double duration_s, const Rigid3& diver_from_body);

/// Pose and size of a sunken ship: a box on the sea floor.
struct WreckLayout {
  Vec3 center_W = Vec3::Zero();  ///< middle of its keel, at the floor
  double azimuth_rad = 0.5;      ///< direction of its bow, counter-clockwise from east
  double length_m = 24.0;
  double width_m = 6.0;
  double height_m = 3.5;

  WreckLayout translated(const Vec3& offset_W) const {
    WreckLayout moved = *this;
    moved.center_W += offset_W;
    return moved;
  }
};

/// Motion around a wreck at varying height, with the rig directed at the hull and tilted freely. The path
/// length is within 2 % of the requested one. Throws UsageError for a speed outside 0.05 to 0.6 m/s.
Motion makeWreckMotion(const WreckLayout& wreck, uint64_t seed, double duration_s, double path_length_m,
                       bool starts_at_rest, const Rigid3& diver_from_body);

}  // namespace lodeline

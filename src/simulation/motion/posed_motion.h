#pragma once

#include <cstdint>

#include "simulation/shared/motion.h"

namespace lodeline {

/// The rig turned about all its axes while the hands draw figures of eight in the water, as for calibrating a
/// magnetometer: still for 4 s, then every direction of the sphere is faced within about 90 s.
Motion makeFigureEightMotion(uint64_t seed, double duration_s, const Rigid3& diver_from_body);

/// On a bench, tilted by a few degrees, not moving at all.
Motion makeMotionAtRest(uint64_t seed, double duration_s, const Rigid3& diver_from_body);

/// Where a sunken ship lies: a box on the sea floor.
struct WreckLayout {
  Vec3 center_W = Vec3::Zero();  ///< middle of its keel, on the floor
  double azimuth_rad = 0.5;      ///< of its bow, counter-clockwise from east
  double length_m = 24.0;
  double width_m = 6.0;
  double height_m = 3.5;

  WreckLayout translated(const Vec3& offset_W) const {
    WreckLayout moved = *this;
    moved.center_W += offset_W;
    return moved;
  }
};

/// Rounds about a wreck, rising and sinking, the rig pointed at the hull and tilted freely. Path length
/// within 2 % of what is asked for. Throws UsageError for a speed outside 0.05 to 0.6 m/s.
Motion makeWreckMotion(const WreckLayout& wreck, uint64_t seed, double duration_s, double path_length_m,
                       bool starts_at_rest, const Rigid3& diver_from_body);

}  // namespace lodeline

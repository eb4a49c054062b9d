#pragma once

#include <optional>

#include "simulation/rendering/light/lamp.h"

namespace lodeline {

/// A second diver beside the rig, who sweeps a narrow torch.
struct SecondDiver {
  Vec3 position_B = Vec3(-0.8, 0.9, 0.3);  ///< x forward, y left, z up of the level rig frame, m
  double spot_intensity = 12.0;            ///< W/sr
  double spot_half_angle_rad = 0.10;
  double sweep_rad = 0.7;      ///< amplitude about straight ahead
  double period_s = 7.0;       ///< of one sweep
  double visible_share = 0.5;  ///< fraction of the time; otherwise the diver is away
};

/// The torch at one moment; nothing while the second diver is away. `forward_W` is the viewing direction of
/// the rig's cameras. Deterministic in seed and time.
std::optional<PlacedLamp> placeSecondDiver(const SecondDiver& diver, const Vec3& rig_position_W,
                                           const Vec3& forward_W, double time_s, uint64_t seed);

}  // namespace lodeline

#pragma once

#include <vector>

#include "simulation/rendering/bodies/ellipsoid.h"
#include "simulation/shared/track.h"

namespace lodeline {

/// A second diver who swims in view of the cameras, with a torch in the hand.
struct Buddy {
  PoseTrack world_from_buddy;  ///< x forward, y left, z up; origin in the chest
  double kick_hz = 0.55;
  double spot_intensity = 9.0;  ///< of the torch, W/sr
  double spot_half_angle_rad = 0.11;
  double sweep_rad = 0.5;  ///< amplitude of the torch about straight ahead
};

/// Position and unit direction of the torch at one moment, world frame.
struct TorchPose {
  Vec3 position_W, direction_W;
};
TorchPose torchOf(const Buddy& buddy, double time_s);

/// Adds the parts of the body at one moment: trunk, tank, head, arms, and legs with fins that kick.
void placeBuddy(const Buddy& buddy, double time_s, std::vector<PlacedEllipsoid>& bodies);

}  // namespace lodeline

#pragma once

#include <memory>
#include <vector>

#include "simulation/rendering/bodies/ellipsoid.h"
#include "simulation/shared/track.h"

namespace lodeline {

/// Some fish of one kind that swim past together.
struct FishSchool {
  double middle_s = 0.0;  ///< when it is at its anchor
  Vec3 anchor_W = Vec3::Zero();
  Vec3 velocity_W = Vec3::Zero();  ///< through the water, m/s
  int count = 3;
  double length_m = 0.2;  ///< of one fish
  uint32_t seed = 0;
};

/// Time before and after its middle for which a school exists, s.
inline constexpr double kSchoolLife_s = 12.0;

/// Adds the parts of all fish at one moment. A current carries them while they swim.
void placeFish(const std::vector<FishSchool>& schools, const DriftTrack* current, double time_s,
               std::vector<PlacedEllipsoid>& bodies);

}  // namespace lodeline

#include "simulation/rendering/bodies/fish.h"

#include <cmath>
#include <numbers>

#include "simulation/rendering/cave/gradient_noise.h"
#include "simulation/rendering/optics/pixel_hash.h"

namespace lodeline {
namespace {

/// A random number of fish `fish`, -1..1.
double drawn(const FishSchool& school, int fish, int number) {
  const uint64_t hash =
      combineHash(school.seed, combineHash(static_cast<uint64_t>(fish), static_cast<uint64_t>(number)));
  return 2.0 * uniformFromHash(hash) - 1.0;
}

/// Pose of axes x forward, y left, z up that look along a direction.
Quat heading(const Vec3& forward_W) {
  const Vec3 x = forward_W.normalized();
  const Vec3 y = Vec3::UnitZ().cross(x).normalized();
  Mat3 rotation;
  rotation << x, y, x.cross(y);
  return Quat(rotation);
}

Vec3 positionOf(const FishSchool& school, int fish, const DriftTrack* current, double time_s) {
  const double since_s = time_s - school.middle_s;
  const auto wander = [&](uint32_t axis) {
    return gradientNoise(Vec3f(static_cast<float>(0.5 * time_s), 0.31f + static_cast<float>(fish), 0.73f),
                         school.seed + axis);
  };
  const Vec3 place = school.length_m * Vec3(4.0 * drawn(school, fish, 1), 3.0 * drawn(school, fish, 2),
                                            1.5 * drawn(school, fish, 3));
  const Vec3 stray = 0.12 * Vec3(wander(1), wander(2), 0.5 * wander(3));
  const Vec3 carried =
      current != nullptr ? Vec3(current->at(time_s) - current->at(school.middle_s)) : Vec3(Vec3::Zero());
  return school.anchor_W + since_s * school.velocity_W + place + stray + carried;
}

/// The trunk, a tail that beats, and a fin on the back.
void addFish(const FishSchool& school, int fish, const Rigid3& world_from_fish, double time_s,
             std::vector<PlacedEllipsoid>& bodies) {
  const double length_m = school.length_m * (1.0 + 0.15 * drawn(school, fish, 4));
  const double beat =
      std::sin(2.0 * std::numbers::pi * (2.2 + 0.5 * drawn(school, fish, 5)) * time_s + 3.0 * fish);
  BodyPart skin;
  skin.back_reflectance = 0.03f;
  skin.belly_reflectance = 0.07f;
  skin.contrast = 0.55f;
  skin.stripes_per_length = (school.seed & 1) != 0 ? 6.0f : 0.0f;
  skin.gloss = 0.06f;
  skin.seed = school.seed + static_cast<uint32_t>(17 * fish);
  const auto add = [&](const Rigid3& fish_from_part, const Vec3& half_axes) {
    skin.world_from_part = world_from_fish * fish_from_part;
    skin.half_axes_m = length_m * half_axes;
    bodies.emplace_back(skin);
  };
  const auto turned = [](double angle_rad, const Vec3& axis) {
    return Quat(Eigen::AngleAxisd(angle_rad, axis));
  };
  add(Rigid3(turned(0.06 * beat, Vec3::UnitZ()), Vec3::Zero()), Vec3(0.40, 0.075, 0.14));
  const Quat tail = turned(-0.45 * beat, Vec3::UnitZ());
  const Vec3 root = length_m * Vec3(-0.34, -0.02 * beat, 0.0);
  add(Rigid3(tail, root + tail * (length_m * Vec3(-0.10, 0.0, 0.0))), Vec3(0.13, 0.02, 0.045));
  for (const double side : {1.0, -1.0}) {
    const Quat lobe = tail * turned(0.65 * side, Vec3::UnitY());
    add(Rigid3(lobe, root + tail * (length_m * Vec3(-0.24, 0.0, 0.06 * side))), Vec3(0.10, 0.008, 0.035));
  }
  add(Rigid3(turned(0.3, Vec3::UnitY()), length_m * Vec3(-0.03, 0.0, 0.13)), Vec3(0.15, 0.008, 0.06));
}

}  // namespace

void placeFish(const std::vector<FishSchool>& schools, const DriftTrack* current, double time_s,
               std::vector<PlacedEllipsoid>& bodies) {
  for (const FishSchool& school : schools) {
    if (std::abs(time_s - school.middle_s) > kSchoolLife_s) continue;
    for (int fish = 0; fish < school.count; ++fish) {
      const Vec3 here = positionOf(school, fish, current, time_s);
      // Fish look where they swim in the water, not where the current carries them.
      const Vec3 ahead =
          positionOf(school, fish, nullptr, time_s + 0.2) - positionOf(school, fish, nullptr, time_s - 0.2);
      addFish(school, fish, Rigid3(heading(ahead + Vec3(1e-6, 0.0, 0.0)), here), time_s, bodies);
    }
  }
}

}  // namespace lodeline

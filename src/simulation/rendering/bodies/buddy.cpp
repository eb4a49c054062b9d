#include "simulation/rendering/bodies/buddy.h"

#include <cmath>
#include <numbers>

namespace lodeline {
namespace {

const Vec3 kHand(0.62, -0.22, -0.12);

Quat pitched(double angle_rad) { return Quat(Eigen::AngleAxisd(angle_rad, Vec3::UnitY())); }

/// A part between two joints in the buddy's axes.
Rigid3 alongLimb(const Vec3& from, const Vec3& to) {
  return Rigid3(Quat::FromTwoVectors(Vec3::UnitX(), to - from), 0.5 * (from + to));
}

class BodyBuilder {
 public:
  BodyBuilder(const Rigid3& world_from_buddy, std::vector<PlacedEllipsoid>& bodies)
      : world_from_buddy_(world_from_buddy), bodies_(bodies) {}

  void add(const Rigid3& buddy_from_part, const Vec3& half_axes_m, float reflectance, float contrast,
           float gloss = 0.01f) {
    BodyPart part;
    part.world_from_part = world_from_buddy_ * buddy_from_part;
    part.half_axes_m = half_axes_m;
    part.back_reflectance = part.belly_reflectance = reflectance;
    part.contrast = contrast;
    part.gloss = gloss;
    part.seed = static_cast<uint32_t>(bodies_.size()) * 31 + 7;
    bodies_.emplace_back(part);
  }
  void limb(const Vec3& from, const Vec3& to, double radius_m, float reflectance) {
    add(alongLimb(from, to), Vec3(0.55 * (to - from).norm(), radius_m, radius_m), reflectance, 0.4f);
  }

 private:
  Rigid3 world_from_buddy_;
  std::vector<PlacedEllipsoid>& bodies_;
};

}  // namespace

TorchPose torchOf(const Buddy& buddy, double time_s) {
  const Rigid3 pose = buddy.world_from_buddy.at(time_s);
  const double yaw = buddy.sweep_rad * (std::sin(0.83 * time_s) + 0.5 * std::sin(1.91 * time_s + 1.0));
  const double pitch = 0.4 * buddy.sweep_rad * std::sin(0.57 * time_s + 2.0) - 0.1;
  const Vec3 direction(std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch));
  return {pose * Vec3(kHand + Vec3(0.18, 0.0, 0.0)), pose.rotation * direction};
}

void placeBuddy(const Buddy& buddy, double time_s, std::vector<PlacedEllipsoid>& bodies) {
  BodyBuilder body(buddy.world_from_buddy.at(time_s), bodies);
  constexpr float kSuit = 0.022f, kHarness = 0.04f, kTank = 0.12f, kSkin = 0.05f, kFin = 0.05f;
  body.add(Rigid3(), Vec3(0.36, 0.18, 0.12), kSuit, 0.5f);
  body.add(Rigid3(pitched(0.1), Vec3(-0.32, 0.0, -0.02)), Vec3(0.26, 0.155, 0.105), kSuit, 0.5f);
  body.add(Rigid3(Quat::Identity(), Vec3(0.02, 0.0, 0.12)), Vec3(0.28, 0.22, 0.07), kHarness, 0.5f);
  for (const double side : {1.0, -1.0}) {
    body.add(Rigid3(Quat::Identity(), Vec3(-0.08, 0.10 * side, 0.22)), Vec3(0.36, 0.10, 0.10), kTank, 0.25f,
             0.1f);
    // Both legs kick together with bent knees (frog kick): the shins open and close.
    const double kick = std::sin(2.0 * std::numbers::pi * buddy.kick_hz * time_s);
    const Vec3 hip(-0.48, 0.11 * side, -0.02);
    const Vec3 knee = hip + Vec3(-0.36, side * (0.07 + 0.05 * kick), -0.05);
    const Vec3 ankle = knee + Vec3(-0.30 - 0.08 * kick, side * (0.05 + 0.12 * kick), 0.22 - 0.06 * kick);
    const Vec3 toe = ankle + Vec3(-0.42, side * (0.06 - 0.12 * kick), 0.05 - 0.06 * kick);
    body.limb(hip, knee, 0.075, kSuit);
    body.limb(knee, ankle, 0.05, kSuit);
    body.add(alongLimb(ankle, toe), Vec3(0.26, 0.10, 0.015), kFin, 0.3f, 0.03f);
    const Vec3 shoulder(0.26, 0.19 * side, 0.0);
    const Vec3 hand = side < 0.0 ? kHand : Vec3(0.50, 0.16, -0.20);
    const Vec3 elbow = 0.5 * (shoulder + hand) + Vec3(-0.04, 0.10 * side, -0.08);
    body.limb(shoulder, elbow, 0.055, kSuit);
    body.limb(elbow, hand, 0.045, kSuit);
    body.add(Rigid3(Quat::Identity(), hand), Vec3(0.08, 0.045, 0.04), kSkin, 0.3f);
  }
  body.add(Rigid3(Quat::Identity(), Vec3(0.44, 0.0, 0.07)), Vec3(0.14, 0.10, 0.12), kSuit, 0.4f);
  body.add(Rigid3(Quat::Identity(), kHand + Vec3(0.06, 0.0, 0.02)), Vec3(0.09, 0.03, 0.03), 0.08f, 0.2f,
           0.1f);
}

}  // namespace lodeline

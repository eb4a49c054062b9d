#include "simulation/dive/dive_life.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/rendering/optics/water_index.h"
#include "simulation/shared/random.h"

#include "lodeline/util/median.h"

namespace lodeline {
namespace {

constexpr double kStep_s = 0.1;

int stepsOf(const Dive& dive) { return static_cast<int>(std::ceil(dive.motion.duration_s() / kStep_s)) + 1; }

/// Pose of the diver frame (x forward, y left, z up); beyond the ends of the dive, that of the ends.
Rigid3 diverAt(const Dive& dive, double time_s) {
  const double within_s = std::clamp(time_s, 0.0, dive.motion.duration_s());
  return dive.motion.at(within_s).world_from_body * dive.errors.truth.diver_from_body.inverse();
}

Vec3 levelForward(const Rigid3& world_from_diver) {
  Vec3 forward = world_from_diver.rotation * Vec3::UnitX();
  forward.z() = 0.0;
  return forward.normalized();
}

/// The water flows along the passage towards its entrance, or in one direction in open water. Its speed rises
/// and falls over some ten seconds, and eddies carry it sideways.
DriftTrack drawCurrent(const Dive& dive) {
  Random random(dive.scenario.seed, "current");
  const double speed_m_per_s = random.uniform(0.08, 0.25);
  const double azimuth = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double gust_s = random.uniform(9.0, 16.0), eddy_s = random.uniform(4.0, 7.0);
  DriftTrack track{kStep_s, {Vec3::Zero()}};
  double arc_length_m = 0.0;
  for (int i = 1; i < stepsOf(dive); ++i) {
    const double time_s = i * kStep_s;
    Vec3 along(std::cos(azimuth), std::sin(azimuth), 0.0);
    if (dive.passage) {
      const Vec3 here = diverAt(dive, time_s).translation;
      arc_length_m = dive.passage->nearestArcLength(here, arc_length_m, 2.0);
      along = -dive.passage->at(arc_length_m).tangent_W;
    }
    const Vec3 across = Vec3::UnitZ().cross(along).normalized();
    const double gust = 1.0 + 0.35 * std::sin(2.0 * std::numbers::pi * time_s / gust_s);
    const double eddy = 0.25 * std::sin(2.0 * std::numbers::pi * time_s / eddy_s);
    const double lift = 0.12 * std::sin(2.0 * std::numbers::pi * time_s / (0.7 * eddy_s));
    const Vec3 velocity_W = speed_m_per_s * (gust * along + eddy * across + lift * Vec3::UnitZ());
    track.values.push_back(track.values.back() + kStep_s * velocity_W);
  }
  return track;
}

/// Schools that cross the view every 5 to 12 s, 1 to 2.5 m ahead of the diver.
std::vector<FishSchool> drawFish(const Dive& dive) {
  Random random(dive.scenario.seed, "fish");
  std::vector<FishSchool> schools;
  for (double t = random.uniform(2.0, 5.0); t < dive.motion.duration_s(); t += random.uniform(5.0, 12.0)) {
    const Rigid3 diver = diverAt(dive, t);
    const Vec3 forward = levelForward(diver), left = Vec3::UnitZ().cross(forward);
    FishSchool school;
    school.middle_s = t;
    const double ahead_m = random.uniform(1.0, 2.5), aside_m = random.uniform(-0.3, 0.3);
    const double above_m = random.uniform(-0.5, 0.4);
    school.anchor_W = diver.translation + ahead_m * forward + aside_m * left + above_m * Vec3::UnitZ();
    const double slant = random.uniform(-0.9, 0.9), speed_m_per_s = random.uniform(0.12, 0.45);
    school.velocity_W = speed_m_per_s * (random.sign() * std::cos(slant) * left + std::sin(slant) * forward);
    school.count = 1 + static_cast<int>(random.uniform(0.0, 5.0));
    school.length_m = random.uniform(0.09, 0.26);
    school.seed = static_cast<uint32_t>(random.uniform(0.0, 4e9));
    schools.push_back(school);
  }
  return schools;
}

/// A companion 3 m ahead on the mean path of the last seconds. It sways in and out of the view and kicks at
/// another frequency than the diver.
Buddy drawBuddy(const Dive& dive) {
  Random random(dive.scenario.seed, "buddy");
  const double ahead_m = random.uniform(2.9, 3.6), sway_s = random.uniform(17.0, 26.0);
  const double phase = random.uniform(0.0, 2.0 * std::numbers::pi), side = random.sign();
  Buddy buddy;
  buddy.kick_hz = random.uniform(0.45, 0.65);
  buddy.world_from_buddy.step_s = kStep_s;
  constexpr int kMean = 12;
  for (int i = 0; i < stepsOf(dive); ++i) {
    const double t = i * kStep_s;
    Vec3 place = Vec3::Zero(), forward = Vec3::Zero();
    for (int k = 0; k < kMean; ++k) {
      const Rigid3 diver = diverAt(dive, t - 4.0 + 6.0 * (k + 0.5) / kMean);
      place += diver.translation / kMean;
      forward += levelForward(diver);
    }
    forward.normalize();
    const Vec3 left = Vec3::UnitZ().cross(forward);
    const double wave = 2.0 * std::numbers::pi * t / sway_s + phase;
    const double surge_m = 0.05 * std::sin(2.0 * std::numbers::pi * buddy.kick_hz * t);
    const Vec3 centre = place + (ahead_m + 0.3 * std::sin(0.7 * wave) + surge_m) * forward +
                        side * (0.5 + 1.1 * std::sin(wave)) * left +
                        (0.05 + 0.25 * std::sin(1.3 * wave + 1.0)) * Vec3::UnitZ();
    Mat3 axes;
    axes << forward, left, Vec3::UnitZ();
    const double yaw = 0.35 * side * std::cos(wave), roll = 0.08 * std::sin(2.1 * wave);
    const Quat turn(Eigen::AngleAxisd(yaw, Vec3::UnitZ()) * Eigen::AngleAxisd(roll, Vec3::UnitX()));
    buddy.world_from_buddy.values.emplace_back(Quat(axes) * turn, centre);
  }
  return buddy;
}

/// A quarter of the dive is below the interface, so that the dive crosses it.
void addHalocline(Dive& dive) {
  Random random(dive.scenario.seed, "halocline");
  const double fresh_g_per_kg = random.uniform(0.5, 3.0), salt_g_per_kg = random.uniform(30.0, 35.0);
  std::vector<double> heights;
  for (int i = 0; i < stepsOf(dive); ++i) heights.push_back(diverAt(dive, i * kStep_s).translation.z());
  Halocline halocline;
  halocline.height_W = orderStatistic(std::move(heights), 0.25);
  halocline.thickness_m = random.uniform(0.12, 0.3);
  halocline.index_step = waterIndexAt(salt_g_per_kg, 25.0, kMiddleWavelength_nm) -
                         waterIndexAt(fresh_g_per_kg, 25.0, kMiddleWavelength_nm);
  dive.halocline = halocline;
  dive.errors.pressure.halocline_depth_m = dive.surface_height_m - halocline.height_W;
  dive.errors.pressure.density_step =
      waterDensity_kg_per_m3(salt_g_per_kg) / waterDensity_kg_per_m3(fresh_g_per_kg) - 1.0;
}

}  // namespace

void addLife(Dive& dive) {
  const EffectSet& on = dive.scenario.effects;
  if (on.has(Effect::Current)) dive.current = std::make_shared<const DriftTrack>(drawCurrent(dive));
  if (on.has(Effect::Fish)) dive.fish = drawFish(dive);
  if (on.has(Effect::Buddy)) dive.buddy = std::make_shared<const Buddy>(drawBuddy(dive));
  if (on.has(Effect::Halocline)) addHalocline(dive);
}

}  // namespace lodeline

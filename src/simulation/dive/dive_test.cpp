#include "simulation/dive/dive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <tuple>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/util/angles.h"
#include "simulation/dive/dive_world.h"

namespace lodeline {
namespace {

Scenario scenario(const char* name, const char* realism, std::vector<std::string> effects = {},
                  uint64_t seed = 1) {
  ScenarioChanges changes;
  changes.realism = realism;
  changes.effects = std::move(effects);
  changes.seed = seed;
  return makeScenario(name, changes);
}

double turnBetween(const Rigid3& a, const Rigid3& b) {
  return so3::log(a.rotation.conjugate() * b.rotation).norm();
}

TEST(DiveErrors, CleanFilesTellTheTruth) {
  const DiveErrors errors = drawErrors(scenario("demo", "clean"));
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(errors.given.cameras[i].fx_px, errors.truth.rig.cameras[i].fx_px);
    EXPECT_EQ(errors.given.cameras[i].body_from_camera.matrix(),
              errors.truth.rig.cameras[i].body_from_camera.matrix());
  }
  EXPECT_EQ(errors.given.magnetometer->body_from_magnetometer.matrix(),
            errors.magnetometer.body_from_magnetometer.matrix());
  EXPECT_EQ(errors.camera_clock.delay_s, 0.0);
  EXPECT_EQ(errors.imu.gyroscope.matrix, Mat3::Identity());
}

TEST(DiveErrors, FieldFilesAreOffByWhatTheFieldIsOffBy) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const DiveErrors errors = drawErrors(scenario("demo", "field", {}, seed));
    for (size_t i = 0; i < 2; ++i) {
      const CameraCalibration& given = errors.given.cameras[i];
      const CameraCalibration& truth = errors.in_water.cameras[i];
      const double focal = std::abs(given.fx_px / truth.fx_px - 1.0);
      EXPECT_GE(focal, 0.00099);
      EXPECT_LE(focal, 0.00501);
      const double center = std::hypot(given.cx_px - truth.cx_px, given.cy_px - truth.cy_px);
      EXPECT_GE(center, 0.99);
      EXPECT_LE(center, 3.01);
    }
    const Rigid3& given0 = errors.given.cameras[0].body_from_camera;
    const Rigid3& truth0 = errors.in_water.cameras[0].body_from_camera;
    EXPECT_GE(turnBetween(given0, truth0), 0.099 * kDegree);
    EXPECT_LE(turnBetween(given0, truth0), 0.501 * kDegree);
    EXPECT_GE((given0.translation - truth0.translation).norm(), 0.0049);
    EXPECT_LE((given0.translation - truth0.translation).norm(), 0.0101);
    const Rigid3 given_stereo = given0.inverse() * errors.given.cameras[1].body_from_camera;
    const Rigid3 true_stereo = truth0.inverse() * errors.in_water.cameras[1].body_from_camera;
    EXPECT_GE(turnBetween(given_stereo, true_stereo), 0.0199 * kDegree);
    EXPECT_LE(turnBetween(given_stereo, true_stereo), 0.1001 * kDegree);
    EXPECT_LT((given_stereo.translation - true_stereo.translation).norm(), 1e-9);
    EXPECT_GE(errors.camera_clock.delay_s, 0.003);
    EXPECT_LE(errors.camera_clock.delay_s, 0.008);
    EXPECT_GE(errors.dropped_image_share, 0.01);
    EXPECT_LE(errors.dropped_image_share, 0.03);
    EXPECT_TRUE(errors.port.has_value());
  }
}

TEST(DiveErrors, EveryEffectActsAloneAndLeavesTheOthersAsDrawn) {
  const DiveErrors all = drawErrors(scenario("demo", "field"));
  const DiveErrors without = drawErrors(scenario("demo", "field", {"camera_intrinsics=off"}));
  EXPECT_EQ(without.given.cameras[0].fx_px, without.in_water.cameras[0].fx_px);
  EXPECT_EQ(without.given.cameras[0].body_from_camera.matrix(),
            all.given.cameras[0].body_from_camera.matrix());
  EXPECT_EQ(without.camera_clock.delay_s, all.camera_clock.delay_s);
  EXPECT_EQ(without.imu.gyroscope.turn_on_bias, all.imu.gyroscope.turn_on_bias);

  const DiveErrors alone = drawErrors(scenario("demo", "clean", {"camera_delay=on"}));
  EXPECT_EQ(alone.camera_clock.delay_s, all.camera_clock.delay_s);
  EXPECT_EQ(alone.camera_clock.jitter_s, 0.0);
  EXPECT_EQ(alone.given.cameras[0].fx_px, alone.truth.rig.cameras[0].fx_px);
}

TEST(DiveErrors, CalibrationRecordingsShowTheSameRigAsTheDive) {
  const DiveErrors dive = drawErrors(scenario("cave1_short", "clean", {}, 7));
  for (const char* name : {"figure_eight", "bench"}) {
    const DiveErrors other = drawErrors(scenario(name, "clean", {}, 7));
    EXPECT_EQ(dive.magnetometer.hard_iron_T, other.magnetometer.hard_iron_T);
    EXPECT_EQ(dive.magnetometer.soft_iron, other.magnetometer.soft_iron);
    EXPECT_EQ(dive.imu.gyroscope.turn_on_bias, other.imu.gyroscope.turn_on_bias);
  }
}

TEST(DiveErrors, ThePortBendsTheRaysBeyondItsBestFit) {
  const DiveErrors errors = drawErrors(scenario("demo", "clean", {"flat_port=on"}));
  EXPECT_GT(errors.port_fit_rms_px, 0.005);
  EXPECT_LT(errors.port_fit_rms_px, 1.0);
  EXPECT_NEAR(errors.in_water.cameras[0].fx_px / errors.truth.rig.cameras[0].fx_px, 1.335, 0.05);
  EXPECT_EQ(errors.given.cameras[0].fx_px, errors.in_water.cameras[0].fx_px);
}

TEST(DiveErrors, FilesWithThePortDescribeTheRenderedCamera) {
  const DiveErrors errors = drawErrors(scenario("demo", "clean", {"flat_port=on", "port_in_files=on"}));
  const CameraCalibration& in_air = errors.truth.rig.cameras[0];
  const auto camera = makeCamera(errors.given.cameras[0]), lens = makeCamera(in_air);
  EXPECT_FALSE(in_air.port);
  for (const Vec2& pixel : {Vec2(5.0, 8.0), Vec2(200.0, 160.0), Vec2(310.0, 20.0)}) {
    const auto ray = throughPort(*errors.port, *lens->unproject(pixel));
    for (const double length_m : {0.3, 2.0, 15.0}) {
      const auto back = camera->project(ray->origin_C + length_m * ray->direction_C);
      ASSERT_TRUE(back);
      EXPECT_LT((*back - pixel).norm(), 1e-8);
    }
  }
}

TEST(Dive, HasTheDisturbancesAndTheWaterThatItsEffectsAskFor) {
  const Dive clean = makeDive(scenario("cave1_short", "clean"));
  EXPECT_TRUE(clean.disturbances.lying.empty());
  EXPECT_TRUE(clean.disturbances.passing.empty());
  EXPECT_TRUE(renderSettings(clean).water.silt.empty());
  EXPECT_FALSE(renderSettings(clean).second_diver.has_value());
  const Dive field = makeDive(scenario("cave1_short", "field"));
  EXPECT_GE(field.disturbances.lying.size() + field.disturbances.passing.size(), 3u);
  EXPECT_FALSE(field.disturbances.switched.empty());
  EXPECT_TRUE(renderSettings(field).second_diver.has_value());
  EXPECT_GT(renderSettings(field).water.attenuation_per_m,
            2.0 * renderSettings(clean).water.attenuation_per_m);
  const auto silt = renderSettings(field).water.silt;
  ASSERT_GE(silt.size(), 4u);
  for (const SiltEpisode& episode : silt) {
    EXPECT_GE(episode.duration_s, 3.0);
    EXPECT_LE(episode.duration_s, 8.0);
  }
}

TEST(Dive, IsAsLongAsItsScenarioSays) {
  for (const char* name : {"cave1_short", "cave1_long", "demo", "open_water"}) {
    for (uint64_t seed = 1; seed <= 3; ++seed) {
      const Dive dive = makeDive(scenario(name, "clean", {}, seed));
      const double asked = dive.scenario.path_length_m;
      EXPECT_NEAR(pathLength(dive.motion, 0.0, dive.motion.duration_s()), asked, 0.02 * asked)
          << name << seed;
      EXPECT_LT(dive.motion.at(0.0).world_from_body.translation.norm(), 1e-9);
    }
  }
}

TEST(Dive, RefusesSpeedsThatNobodySwims) {
  ScenarioChanges changes;
  changes.seconds = 60.0;
  changes.metres = 100.0;
  EXPECT_THROW(makeDive(makeScenario("cave1_short", changes)), UsageError);
}

TEST(FigureEight, FacesEveryDirection) {
  const Dive dive = makeDive(scenario("figure_eight", "clean"));
  std::set<std::tuple<int, int>> seen;  // 72 sphere bins of equal area
  double largest_rate = 0.0;
  for (double t = 0.0; t < 90.0; t += 0.05) {
    const MotionState state = dive.motion.at(t);
    const Vec3 field_B = state.world_from_body.rotation.conjugate() * dive.field_W.normalized();
    const int band = std::min(5, static_cast<int>(3.0 * (field_B.z() + 1.0)));
    const int sector =
        std::min(11, static_cast<int>((std::atan2(field_B.y(), field_B.x()) / std::numbers::pi + 1.0) * 6.0));
    seen.emplace(band, sector);
    largest_rate = std::max(largest_rate, state.angular_velocity_B.norm());
  }
  EXPECT_GE(seen.size(), 65u);
  EXPECT_LT(largest_rate, 2.5);
  EXPECT_LT(dive.motion.at(3.9).angular_velocity_B.norm(), 1e-9);
}

TEST(Bench, DoesNotMove) {
  const Dive dive = makeDive(scenario("bench", "clean"));
  EXPECT_EQ(dive.motion.duration_s(), 10800.0);
  for (const double t : {0.0, 5000.0, 10799.0}) {
    EXPECT_LT(dive.motion.at(t).velocity_W.norm(), 1e-12);
    EXPECT_LT(dive.motion.at(t).angular_velocity_B.norm(), 1e-12);
  }
}

TEST(OpenWater, IsSwumAtOneSpeedAllTheWayRound) {
  const Dive dive = makeDive(scenario("open_water", "clean"));
  EXPECT_NEAR(pathLength(dive.motion, 0.0, 400.0), 100.0, 1.5);
  // Halts and changes of speed average out over a minute. Uneven spacing of the path parameter at bow and
  // stern would not.
  for (double t = 20.0; t < 320.0; t += 10.0)
    EXPECT_NEAR(pathLength(dive.motion, t, t + 60.0), 15.0, 3.5) << t;
}

TEST(OpenWater, CanBeCutToAShortExcerpt) {
  ScenarioChanges changes;
  changes.seconds = 20.0;
  const Dive dive = makeDive(makeScenario("open_water", changes));
  EXPECT_NEAR(pathLength(dive.motion, 0.0, 20.0), 5.0, 0.5);
}

TEST(OpenWater, LooksAtTheWreckFromOutside) {
  const Dive dive = makeDive(scenario("open_water", "clean"));
  ASSERT_TRUE(dive.wreck.has_value());
  double cosine_sum = 0.0;
  int count = 0;
  for (double t = 0.0; t < dive.motion.duration_s(); t += 1.0) {
    const Rigid3 pose = dive.motion.at(t).world_from_body;
    const Vec3 forward =
        pose.rotation * (dive.errors.truth.diver_from_body.rotation.conjugate() * Vec3::UnitX());
    const Vec3 towards = dive.wreck->center_W - pose.translation;
    EXPECT_GT(towards.head<2>().norm(), 0.5 * dive.wreck->width_m + 1.5);
    cosine_sum += forward.head<2>().normalized().dot(towards.head<2>().normalized());
    ++count;
  }
  EXPECT_GT(cosine_sum / count, 0.7);
}

}  // namespace
}  // namespace lodeline

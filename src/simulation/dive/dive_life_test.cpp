// The effects that the estimator knows nothing about have the sizes that their descriptions state.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lodeline/util/angles.h"
#include "simulation/dive/dive_world.h"
#include "simulation/sensors/pressure_model.h"

namespace lodeline {
namespace {

Dive diveWith(std::vector<std::string> effects, uint64_t seed = 1) {
  ScenarioChanges changes;
  changes.effects = std::move(effects);
  changes.seed = seed;
  return makeDive(makeScenario("demo", changes));
}

TEST(PhysicalEffects, LevelsNestAndPhysicalHasOnePort) {
  for (const EffectDescription& d : effectDescriptions()) {
    EXPECT_TRUE(!d.in_clean || d.in_field) << d.name;
    EXPECT_TRUE(!d.in_field || d.in_physical) << d.name;
  }
  ScenarioChanges changes;
  changes.realism = "physical";
  const EffectSet effects = makeScenario("demo", changes).effects;
  for (const Effect effect : {Effect::PortTilt, Effect::Dispersion, Effect::GSensitivity, Effect::Current,
                              Effect::Fish, Effect::Buddy, Effect::Halocline, Effect::RollingShutter}) {
    EXPECT_TRUE(effects.has(effect));
  }
  EXPECT_FALSE(effects.has(Effect::DomePort));
  // Recordings without these effects keep their identity.
  EXPECT_EQ(describe(makeScenario("demo", {})).find("fish"), std::string::npos);
  EXPECT_NE(describe(makeScenario("demo", changes)).find("  fish: on"), std::string::npos);
}

TEST(PhysicalEffects, PortsAreOffByWhatTheySay) {
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const DiveErrors& tilted = diveWith({"port_tilt=on"}, seed).errors;
    const FlatPort plate = std::get<FlatPort>(tilted.port.value());
    const double tilt = std::acos(plate.normal_C.normalized().z());
    EXPECT_GE(tilt, 0.4 * kDegree);
    EXPECT_LE(tilt, 1.0 * kDegree);
    EXPECT_LT(tilted.port_fit_rms_px, 1.0);
    const DiveErrors& domed = diveWith({"dome_port=on"}, seed).errors;
    const DomePort dome = std::get<DomePort>(domed.port.value());
    EXPECT_GE(dome.centre_C.norm(), 0.001);
    EXPECT_LE(dome.centre_C.norm(), 0.003);
    // The camera in the files lacks the port, and hardly any of its pixels is wrong by half a pixel.
    EXPECT_FALSE(domed.given.cameras[0].port);
    EXPECT_LT(domed.port_fit_rms_px, 0.5);
    const DiveErrors& told = diveWith({"dome_port=on", "port_in_files=on"}, seed).errors;
    ASSERT_TRUE(told.given.cameras[0].port);
    EXPECT_EQ(told.given.cameras[0].port->type, Port::Type::Dome);
    EXPECT_EQ(told.given.cameras[0].port->centre_C, dome.centre_C);
  }
}

TEST(PhysicalEffects, ReadoutTakesTenToThirtyMilliseconds) {
  double least = 1.0, most = 0.0;
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const double readout_s = diveWith({"rolling_shutter=on"}, seed).errors.readout_s;
    least = std::min(least, readout_s);
    most = std::max(most, readout_s);
  }
  EXPECT_GE(least, 0.010);
  EXPECT_LT(least, 0.015);
  EXPECT_GT(most, 0.025);
  EXPECT_LE(most, 0.030);
  ScenarioChanges changes;
  changes.readout_ms = 20.0;
  const Dive dive = makeDive(makeScenario("demo", changes));
  EXPECT_DOUBLE_EQ(renderSettings(dive).sensor.lineDelay_s(480), 0.020 / 480);
  EXPECT_EQ(diveWith({}).errors.readout_s, 0.0);
}

TEST(PhysicalEffects, CurrentFlowsAlongThePassage) {
  const Dive dive = diveWith({"current=on"});
  ASSERT_TRUE(dive.current);
  double along_sum = 0.0;
  int count = 0;
  for (double t = 1.0; t < dive.motion.duration_s() - 1.0; t += 0.5, ++count) {
    const Vec3 velocity_W = (dive.current->at(t + 0.2) - dive.current->at(t - 0.2)) / 0.4;
    EXPECT_LT(velocity_W.norm(), 0.25 * 1.7);
    const Vec3 here = dive.motion.at(t).world_from_body.translation;
    const double s = dive.passage->nearestArcLength(here, 0.0, 15.0);
    along_sum -= velocity_W.dot(dive.passage->at(s).tangent_W);
  }
  EXPECT_GT(along_sum / count, 0.07);
  EXPECT_LT(along_sum / count, 0.27);
  EXPECT_EQ(renderSettings(dive).snow.current, dive.current);
  EXPECT_FALSE(diveWith({}).current);
}

TEST(PhysicalEffects, FishAndBuddyAreAhead) {
  const Dive dive = diveWith({"fish=on", "buddy=on"});
  EXPECT_GE(dive.fish.size(), 3u);
  for (const FishSchool& school : dive.fish) {
    const Rigid3 diver =
        dive.motion.at(school.middle_s).world_from_body * dive.errors.truth.diver_from_body.inverse();
    EXPECT_LT((school.anchor_W - diver.translation).norm(), 3.0);
    EXPECT_GT((school.anchor_W - diver.translation).norm(), 0.8);
    EXPECT_LT(school.velocity_W.norm(), 0.46);
  }
  double nearest_m = 1e9, farthest_m = 0.0;
  for (double t = 0.0; t < dive.motion.duration_s(); t += 0.5) {
    const double distance_m =
        (dive.buddy->world_from_buddy.at(t).translation - dive.motion.at(t).world_from_body.translation)
            .norm();
    nearest_m = std::min(nearest_m, distance_m);
    farthest_m = std::max(farthest_m, distance_m);
  }
  EXPECT_GT(nearest_m, 1.5);  // the fins are 1.3 m behind the chest
  EXPECT_LT(farthest_m, 6.0);
}

TEST(PhysicalEffects, BelowTheHaloclineTheGaugeReadsTooDeepByTheDensity) {
  const Dive dive = diveWith({"halocline=on"});
  ASSERT_TRUE(dive.halocline);
  EXPECT_NEAR(dive.halocline->index_step, 0.0058, 0.0006);
  EXPECT_NEAR(dive.errors.pressure.density_step, 0.023, 0.003);
  int below = 0, count = 0;
  PressureErrors errors;
  errors.halocline_depth_m = dive.errors.pressure.halocline_depth_m;
  errors.density_step = dive.errors.pressure.density_step;
  const Rigid3 body_from_pressure = dive.errors.truth.rig.pressure->body_from_pressure;
  PressureModel layered(dive.motion, body_from_pressure, dive.surface_height_m, errors, 1);
  for (double t = 0.0; t < dive.motion.duration_s(); t += 0.5, ++count) {
    const double depth_m =
        dive.surface_height_m - (dive.motion.at(t).world_from_body * body_from_pressure.translation).z();
    const double under_m = std::max(0.0, depth_m - *errors.halocline_depth_m);
    below += under_m > 0.0;
    EXPECT_NEAR(layered.measure(t), depth_m + errors.density_step * under_m, 1e-9);
  }
  EXPECT_GT(below, 0.1 * count);
  EXPECT_LT(below, 0.5 * count);
  EXPECT_TRUE(dive.errors.port);  // the index acts through a port
}

}  // namespace
}  // namespace lodeline

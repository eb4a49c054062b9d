#include "simulation/dive/vehicle_dive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/util/angles.h"
#include "simulation/dive/point_dive.h"

namespace lodeline {
namespace {

Scenario scenario(const char* name, double metres, std::vector<std::string> effects,
                  const char* realism = "clean", bool cables_moved = false) {
  ScenarioChanges changes;
  changes.realism = realism;
  changes.effects = std::move(effects);
  if (metres > 0.0) changes.metres = metres;
  changes.cables_moved = cables_moved;
  return makeScenario(name, changes);
}

const std::vector<std::string> kExact = {"imu_noise=off", "imu_bias=off", "magnetometer_noise=off",
                                         "dvl_noise=off", "sonar_noise=off"};

std::vector<std::string> exactAnd(std::vector<std::string> more) {
  more.insert(more.begin(), kExact.begin(), kExact.end());
  return more;
}

std::vector<SimulatedFrame> frames(const VehicleDive& dive) {
  PointSimulationOptions options = dive.options;
  options.frame_rate_hz = 5.0;
  PointSimulation simulation = dive.simulate(options);
  std::vector<SimulatedFrame> all;
  while (auto frame = simulation.next()) all.push_back(std::move(*frame));
  return all;
}

TEST(VehicleDive, BeamsInertialReadingsAndRangesAgreeWithTheTruth) {
  const VehicleDive vehicle = makeVehicleDive(scenario("auv", 20.0, exactAnd({})));
  const Dive& dive = vehicle.dive;
  const DvlCalibration& dvl = *vehicle.trueRig().dvl;
  const SeaFloor ground(dive.scenario.seed);
  Vec3 path_W = Vec3::Zero();
  int pings = 0, ranges = 0, currents = 0;
  double fewest_tracks = 1e9, last_s = 0.0, begin_s = -1.0;
  for (const SimulatedFrame& frame : frames(vehicle)) {
    fewest_tracks = std::min(fewest_tracks, static_cast<double>(frame.tracks.observations.size()));
    for (const DvlSample& ping : frame.dvl) {
      ++pings;
      const double t = (ping.time - dive.start).seconds();
      Eigen::Matrix<double, 4, 3> beams;
      Eigen::Vector4d velocities;
      const Rigid3 world_from_dvl = dive.motion.at(t).world_from_body * dvl.body_from_dvl;
      for (int i = 0; i < 4; ++i) {
        ASSERT_TRUE(ping.beams[i].velocity_m_per_s);
        beams.row(i) = dvl.beams_D[i];
        velocities[i] = *ping.beams[i].velocity_m_per_s;
        // The echo is where the floor is.
        const Vec3 hit = world_from_dvl * Vec3(*ping.beams[i].range_m * dvl.beams_D[i]);
        const Vec3f place = hit.cast<float>() - dive.sea_floor->origin_W;
        const float above_ground_m = place.z() - ground.height_m(place.x(), place.y());
        EXPECT_GT(above_ground_m, -0.08f);
        EXPECT_LT(above_ground_m, 0.8f);  // on a stone
      }
      const Vec3 velocity_D = beams.colPivHouseholderQr().solve(velocities);
      if (begin_s >= 0.0) path_W += (t - last_s) * (world_from_dvl.rotation * velocity_D);
      if (begin_s < 0.0) begin_s = t;
      last_s = t;
    }
    for (const AltimeterSample& sample : frame.altimeter) {
      ++ranges;
      EXPECT_GT(sample.range_m, 0.8);
      EXPECT_LT(sample.range_m, 3.0);
    }
    currents += static_cast<int>(frame.currents.size());
  }
  const auto place = [&](double t) {
    return Vec3(dive.motion.at(t).world_from_body * dvl.body_from_dvl.translation);
  };
  // A sum of rectangles over 0.2 s.
  EXPECT_LT((path_W - (place(last_s) - place(begin_s))).norm(), 0.05);
  EXPECT_NEAR(pings, 5.0 * dive.motion.duration_s(), 2.0);
  EXPECT_NEAR(ranges, 10.0 * dive.motion.duration_s(), 3.0);
  EXPECT_NEAR(currents, 10.0 * dive.motion.duration_s(), 3.0);
  EXPECT_GT(fewest_tracks, 80.0);
}

// Readings with and without an effect.
TEST(VehicleDive, CurrentsAddTheirFieldAndMovedCablesAnother) {
  const auto run = [](std::vector<std::string> effects, bool moved) {
    return makeDive(scenario("auv", 20.0, exactAnd(std::move(effects)), "clean", moved));
  };
  const Dive quiet = run({}, false), loud = run({"thruster_currents=on"}, false),
             moved = run({"thruster_currents=on"}, true);
  const auto reading = [](const Dive& dive, double t) {
    MagnetometerModel model(dive.motion, dive.field_W, dive.disturbances, dive.errors.magnetometer, 50.0, 1);
    return model.measure(t);
  };
  const std::vector<Vec3>& fields = loud.errors.truth.rig.currents->fields_T_per_A;
  double greatest_T = 0.0, greatest_A = 0.0, difference_T = 0.0;
  for (double t = 1.0; t < 50.0; t += 0.37) {
    const std::vector<double> currents_A = channelCurrents(loud.loads(t));
    const Vec3 added = reading(loud, t) - reading(quiet, t);
    EXPECT_LT((added - fieldOfCurrents(fields, currents_A)).norm(), 1e-12);
    greatest_T = std::max(greatest_T, added.norm());
    difference_T = std::max(difference_T, (reading(moved, t) - reading(loud, t)).norm());
    for (int i = 0; i < kThrusters; ++i) greatest_A = std::max(greatest_A, currents_A[i]);
  }
  EXPECT_GT(greatest_T, 2e-6);
  EXPECT_GT(difference_T, 1e-6);
  EXPECT_GT(greatest_A, 3.0);
  EXPECT_LE(greatest_A, 20.0);
  EXPECT_EQ(quiet.errors.truth.rig.currents->fields_T_per_A[0], Vec3(Vec3::Zero()));
  EXPECT_TRUE(loud.errors.given.currents->fields_T_per_A.empty());
}

TEST(VehicleDive, VibrationShakesTheImuAloneAndEverySimulationAlike) {
  const VehicleDive still = makeVehicleDive(scenario("auv", 8.0, exactAnd({})));
  const VehicleDive shaken = makeVehicleDive(scenario("auv", 8.0, exactAnd({"vibration=on"})));
  const auto a = frames(still), b = frames(shaken), again = frames(shaken);
  ASSERT_EQ(a.size(), b.size());
  double squares = 0.0;
  int count = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].imu.size(), b[i].imu.size());
    for (size_t k = 0; k < a[i].imu.size(); ++k, ++count) {
      squares += (a[i].imu[k].specific_force_B - b[i].imu[k].specific_force_B).squaredNorm();
      EXPECT_EQ(b[i].imu[k].specific_force_B, again[i].imu[k].specific_force_B);
    }
    ASSERT_EQ(a[i].tracks.observations.size(), b[i].tracks.observations.size());
    EXPECT_EQ(a[i].truth.motion.velocity_W, b[i].truth.motion.velocity_W);
  }
  EXPECT_GT(std::sqrt(squares / count), 0.05);
  EXPECT_LT(std::sqrt(squares / count), 1.5);
}

TEST(VehicleDive, FilesOfTheFieldSayAnotherDvl) {
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    ScenarioChanges changes;
    changes.realism = "field";
    changes.seed = seed;
    const DiveErrors errors = drawErrors(makeScenario("auv", changes));
    const Quat off =
        errors.given.dvl->body_from_dvl.rotation.conjugate() * errors.truth.rig.dvl->body_from_dvl.rotation;
    EXPECT_GE(so3::log(off).norm(), 1.99 * kDegree);
    EXPECT_LE(so3::log(off).norm(), 3.51 * kDegree);
    EXPECT_GE(std::abs(errors.dvl.scale), 0.007);
    EXPECT_LE(std::abs(errors.dvl.scale), 0.013);
    EXPECT_EQ(errors.dvl.dropout_share, 0.10);
    EXPECT_EQ(errors.dvl.sentinel_share, 0.0);
  }
  const DiveErrors clean = drawErrors(makeScenario("auv", {}));
  EXPECT_EQ(clean.dvl.scale, 0.0);
  EXPECT_EQ(clean.given.dvl->body_from_dvl.rotation.coeffs(),
            clean.truth.rig.dvl->body_from_dvl.rotation.coeffs());
}

TEST(VehicleDive, SteelBendsTheFieldAtTheHullAndTheWayIsClear) {
  ScenarioChanges changes;
  changes.laps = 1;
  const VehicleDive vehicle = makeVehicleDive(makeScenario("wreck", changes));
  const Dive& dive = vehicle.dive;
  ASSERT_GT(dive.disturbances.steel.size(), 200u);
  double greatest_T = 0.0, greatest_turn = 0.0, nearest_m = 1e9;
  int turned = 0, count = 0;
  for (double t = 0.0; t < dive.motion.duration_s(); t += 0.5, ++count) {
    const Vec3 here = dive.motion.at(t).world_from_body.translation;
    const Vec3 steel = fieldOfDipoles(dive.disturbances.steel, here);
    greatest_T = std::max(greatest_T, steel.norm());
    const double turn = std::abs(headingDeflection(dive.field_W, steel));
    greatest_turn = std::max(greatest_turn, turn);
    turned += turn > 5.0 * kDegree;
    for (const Vec3& direction : {Vec3(Vec3::UnitX()), Vec3(-Vec3::UnitX()), Vec3(Vec3::UnitY()),
                                  Vec3(-Vec3::UnitY()), Vec3(Vec3::UnitZ()), Vec3(-Vec3::UnitZ())})
      nearest_m = std::min(nearest_m, vehicle.range(here, direction).value_or(1e9));
  }
  EXPECT_GT(nearest_m, 0.4);
  EXPECT_GT(greatest_T, 5e-6);
  EXPECT_LT(greatest_T, 100e-6);
  EXPECT_GT(greatest_turn, 20.0 * kDegree);
  EXPECT_GT(turned, 0.2 * count);
  // The Earth's field at both ends of the dive.
  for (const double t : {0.0, dive.motion.duration_s()}) {
    const Vec3 steel = fieldOfDipoles(dive.disturbances.steel, dive.motion.at(t).world_from_body.translation);
    EXPECT_LT(std::abs(headingDeflection(dive.field_W, steel)), 1.5 * kDegree) << t;
  }
  EXPECT_TRUE(makeDive(scenario("wreck", 60.0, {"steel=off"})).disturbances.steel.empty());
}

TEST(VehicleDive, EffectsOfAVehicleAreRefusedElsewhere) {
  EXPECT_THROW(scenario("demo", 0.0, {"vibration=on"}), UsageError);
  EXPECT_THROW(scenario("auv", 0.0, {"steel=on"}), UsageError);
  EXPECT_THROW(scenario("demo", 0.0, {}, "clean", true), UsageError);
  EXPECT_NO_THROW(scenario("demo", 0.0, {"vibration=off"}, "physical"));
}

}  // namespace
}  // namespace lodeline

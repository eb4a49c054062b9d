#include "simulation/vehicle/vehicle_thrust.h"

#include <gtest/gtest.h>

#include "simulation/motion/posed_motion.h"
#include "simulation/vehicle/vehicle_currents.h"

namespace lodeline {
namespace {

WaterFlow still() {
  return [](double) -> Vec3 { return Vec3::Zero(); };
}

// A figure of eight with all rotations: far more than a vehicle does, and no thruster limits it here.
VehicleDynamics unlimited() {
  VehicleDynamics dynamics;
  dynamics.largest_thrust_N = 1e6;
  return dynamics;
}

TEST(VehicleThrust, SuppliesTheWrenchThatTheMotionNeeds) {
  const Rigid3 vehicle_from_body(Quat(Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized())), Vec3::Zero());
  const Motion motion = makeFigureEightMotion(1, 60.0, vehicle_from_body);
  const VehicleThrust thrust(motion, vehicle_from_body, still(), unlimited());
  for (double t = 0.0; t < 60.0; t += 0.7) {
    EXPECT_LT((thrust.wrenchOf(thrust.at(t)) - thrust.wrench(t)).norm(), 1e-9) << t;
  }
}

TEST(VehicleThrust, HoldsAgainstATideByTheHorizontalThrustersAndAgainstBuoyancyByTheOthers) {
  const Motion motion = makeMotionAtRest(3, 10.0, Rigid3());
  const MotionState rest = motion.at(5.0);
  const Vec3 forward_W = rest.world_from_body.rotation * Vec3::UnitX();
  const VehicleDynamics d;
  const VehicleThrust thrust(motion, Rigid3(), [&](double) -> Vec3 { return -0.5 * forward_W; });
  const Wrench wrench = thrust.wrench(5.0);
  const Vec3 up_D = rest.world_from_body.rotation.conjugate() * Vec3::UnitZ();
  EXPECT_NEAR(wrench[0], d.drag_N_s2_per_m2.x() * 0.25 - d.buoyancy_N * up_D.x(), 1e-9);
  EXPECT_NEAR(wrench[2], -d.buoyancy_N * up_D.z(), 1e-9);
  const Thrusts thrusts = thrust.at(5.0);
  for (int i = 0; i < 4; ++i) {
    EXPECT_GT(thrusts[i], 10.0);
    EXPECT_LT(thrusts[i + 4], -1.0);
  }
}

TEST(VehicleThrust, LimitsThrustAndCurrent) {
  const Motion motion = makeMotionAtRest(3, 10.0, Rigid3());
  const VehicleThrust thrust(motion, Rigid3(), [](double) -> Vec3 { return Vec3(5.0, 0.0, 0.0); });
  const Thrusts thrusts = thrust.at(1.0);
  double largest_N = 0.0;
  for (const double one_N : thrusts) largest_N = std::max(largest_N, std::abs(one_N));
  EXPECT_DOUBLE_EQ(largest_N, 50.0);
  EXPECT_DOUBLE_EQ(thrust.current_A(-largest_N), 20.0);
  EXPECT_DOUBLE_EQ(thrust.current_A(0.0), 0.0);
}

TEST(VehicleCurrents, BatteryCarriesTheSumAndSensorsAreExactWithoutErrors) {
  const Motion motion = makeMotionAtRest(3, 400.0, Rigid3());
  const auto thrust = std::make_shared<VehicleThrust>(motion, Rigid3(), drawWaterFlow(3));
  const LoadsFunction loads = drawVehicleLoads(thrust, 400.0, 3);
  CurrentSensorModel exact(loads, {}, 1), noisy(loads, {0.05, 0.0}, 1);
  double squares = 0.0;
  int count = 0, lamps_on = 0;
  for (double t = 0.0; t < 400.0; t += 0.5) {
    const std::vector<double> truth = channelCurrents(loads(t));
    ASSERT_EQ(truth.size(), currentChannels().size());
    EXPECT_EQ(exact.measure(t), truth);
    double sum_A = loads(t).electronics_A;
    for (size_t i = 0; i + 1 < truth.size(); ++i) sum_A += truth[i];
    EXPECT_NEAR(truth.back(), sum_A, 1e-12);
    lamps_on += truth[kThrusters] > 0.0;
    const std::vector<double> reading = noisy.measure(t);
    for (size_t i = 0; i < truth.size(); ++i, ++count) squares += std::pow(reading[i] - truth[i], 2);
  }
  EXPECT_NEAR(std::sqrt(squares / count), 0.05, 0.002);
  EXPECT_GT(lamps_on, 400);
  EXPECT_LT(lamps_on, 798);
}

}  // namespace
}  // namespace lodeline

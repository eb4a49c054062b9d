#include "simulation/vehicle/vehicle_thrust.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "simulation/shared/random.h"
#include "simulation/shared/waves.h"

namespace lodeline {
namespace {

struct Thruster {
  Vec3 position_D, direction_D;
};

// The layout of a BlueROV2 with eight thrusters: 1 to 4 horizontal (front right, front left, rear right, rear
// left), 5 to 8 vertical in the same order.
const std::array<Thruster, kThrusters>& thrusters() {
  static const std::array<Thruster, kThrusters> table = [] {
    constexpr double kDiagonal = 1.0 / std::numbers::sqrt2;
    std::array<Thruster, kThrusters> made;
    for (int i = 0; i < 4; ++i) {
      const double front = i < 2 ? 1.0 : -1.0, left = i % 2 == 1 ? 1.0 : -1.0;
      made[i] = {Vec3(0.156 * front, 0.111 * left, 0.0), kDiagonal * Vec3(1.0, -front * left, 0.0)};
      made[i + 4] = {Vec3(0.120 * front, 0.218 * left, 0.0), Vec3::UnitZ()};
    }
    return made;
  }();
  return table;
}

Vec3 quadratic(const Vec3& drag, const Vec3& v) { return drag.cwiseProduct(v.cwiseAbs().cwiseProduct(v)); }

}  // namespace

VehicleThrust::VehicleThrust(const Motion& motion, const Rigid3& vehicle_from_body, WaterFlow flow,
                             const VehicleDynamics& dynamics)
    : motion_(motion), vehicle_from_body_(vehicle_from_body), flow_(std::move(flow)), dynamics_(dynamics) {
  for (int i = 0; i < kThrusters; ++i) {
    const Thruster& t = thrusters()[i];
    wrench_per_thrust_.col(i) << t.direction_D, t.position_D.cross(t.direction_D);
  }
  const Eigen::Matrix<double, 6, 6> square = wrench_per_thrust_ * wrench_per_thrust_.transpose();
  thrust_per_wrench_ = wrench_per_thrust_.transpose() * square.inverse();
}

Wrench VehicleThrust::wrench(double time_s) const {
  const MotionState state = motion_.at(time_s);
  const Quat vehicle_from_world = vehicle_from_body_.rotation * state.world_from_body.rotation.conjugate();
  const Vec3 velocity_D = vehicle_from_world * (state.velocity_W - flow_(time_s));
  const Vec3 acceleration_D = vehicle_from_world * state.acceleration_W;
  const Vec3 rate_D = vehicle_from_body_.rotation * state.angular_velocity_B;
  const Vec3 turning_D = vehicle_from_body_.rotation * state.angular_acceleration_B;
  const Vec3 up_D = vehicle_from_world * Vec3::UnitZ();
  Wrench wrench;
  wrench.head<3>() = dynamics_.mass_kg.cwiseProduct(acceleration_D) +
                     quadratic(dynamics_.drag_N_s2_per_m2, velocity_D) - dynamics_.buoyancy_N * up_D;
  // The righting torque turns the vehicle's z axis to up.
  wrench.tail<3>() = dynamics_.inertia_kg_m2.cwiseProduct(turning_D) +
                     quadratic(dynamics_.turning_drag_N_m_s2, rate_D) -
                     dynamics_.righting_N_m_per_rad * Vec3::UnitZ().cross(up_D);
  return wrench;
}

Thrusts VehicleThrust::at(double time_s) const {
  const Eigen::Matrix<double, kThrusters, 1> needed = thrust_per_wrench_ * wrench(time_s);
  Thrusts thrusts;
  for (int i = 0; i < kThrusters; ++i)
    thrusts[i] = std::clamp(needed[i], -dynamics_.largest_thrust_N, dynamics_.largest_thrust_N);
  return thrusts;
}

Wrench VehicleThrust::wrenchOf(const Thrusts& thrusts) const {
  return wrench_per_thrust_ * Eigen::Map<const Eigen::Matrix<double, kThrusters, 1>>(thrusts.data());
}

double VehicleThrust::current_A(double thrust_N) const {
  return dynamics_.current_at_largest_A * std::pow(std::abs(thrust_N) / dynamics_.largest_thrust_N, 1.5);
}

Vec3 VehicleThrust::direction_D(int thruster) { return thrusters()[thruster].direction_D; }

WaterFlow drawWaterFlow(uint64_t seed) {
  Random random(seed, "vehicle/tide");
  const double speed_m_per_s = random.uniform(0.15, 0.30);
  const double azimuth = random.uniform(0.0, 2.0 * std::numbers::pi);
  const Waves gust(seed, "vehicle/gust", 6.0, 40.0), eddy(seed, "vehicle/eddy", 4.0, 20.0);
  const Vec3 along(std::cos(azimuth), std::sin(azimuth), 0.0);
  const Vec3 across = Vec3::UnitZ().cross(along);
  return [=](double t) -> Vec3 {
    return speed_m_per_s * ((1.0 + 0.3 * gust(t)) * along + 0.2 * eddy(t) * across);
  };
}

}  // namespace lodeline

#pragma once

#include <array>
#include <functional>

#include "simulation/shared/motion.h"

namespace lodeline {

constexpr int kThrusters = 8;
/// Thrust of each thruster, N.
using Thrusts = std::array<double, kThrusters>;

/// Velocity of the water in W at a time, m/s.
using WaterFlow = std::function<Vec3(double time_s)>;

/// Inertia and drag of a vehicle of the size of a BlueROV2 with a skid, a DVL and a tether. Axes of the
/// vehicle frame D: x forward, y left, z up.
struct VehicleDynamics {
  Vec3 mass_kg = Vec3(18.0, 24.0, 27.0);              ///< with the added mass of the water, along each axis
  Vec3 inertia_kg_m2 = Vec3(0.5, 0.6, 0.7);           ///< with that of the water, about each axis
  Vec3 drag_N_s2_per_m2 = Vec3(200.0, 260.0, 300.0);  ///< force = -drag |v| v
  Vec3 turning_drag_N_m_s2 = Vec3(2.0, 2.5, 2.5);     ///< torque = -drag |w| w
  double buoyancy_N = 12.0;                           ///< net, upwards
  double righting_N_m_per_rad = 4.0;                  ///< by the weight below the centre of buoyancy
  double largest_thrust_N = 50.0;                     ///< of one thruster
  double current_at_largest_A = 20.0;                 ///< electric current of one thruster at that thrust
};

/// Force (N) and torque (N m) that the thrusters exert on the vehicle, in D.
using Wrench = Eigen::Matrix<double, 6, 1>;

/// Thrust that a motion needs. The thrusters supply the wrench
///   F = m a + D |v| v - buoyancy,   T = J w' + E |w| w + righting torque
/// a is the acceleration and v the velocity through the water, at the origin of D. Four thrusters are
/// horizontal at 45 degrees, four are vertical. Of all thrusts with that wrench, these have the least
/// sum of squares.
class VehicleThrust {
 public:
  VehicleThrust(const Motion& motion, const Rigid3& vehicle_from_body, WaterFlow flow,
                const VehicleDynamics& dynamics = {});

  Wrench wrench(double time_s) const;
  Thrusts at(double time_s) const;

  /// Wrench of given thrusts.
  Wrench wrenchOf(const Thrusts& thrusts) const;

  /// Electric current of one thruster, A. The power of a propeller grows with the thrust to the power of 1.5,
  /// and the voltage is constant.
  double current_A(double thrust_N) const;

  /// Unit vector of the thrust of each thruster in D.
  static Vec3 direction_D(int thruster);

 private:
  Motion motion_;
  Rigid3 vehicle_from_body_;
  WaterFlow flow_;
  VehicleDynamics dynamics_;
  Eigen::Matrix<double, 6, kThrusters> wrench_per_thrust_;
  Eigen::Matrix<double, kThrusters, 6> thrust_per_wrench_;
};

/// Draws a tide of 0.15 to 0.3 m/s in one direction, with gusts and eddies over some ten seconds.
WaterFlow drawWaterFlow(uint64_t seed);

}  // namespace lodeline

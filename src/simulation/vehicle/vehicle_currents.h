#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lodeline/rig.h"
#include "simulation/shared/random.h"
#include "simulation/vehicle/vehicle_thrust.h"

namespace lodeline {

constexpr int kLamps = 2;
constexpr double kLampCurrent_A = 2.0;

/// Electric consumers of a vehicle at one time, A.
struct ElectricLoads {
  std::array<double, kThrusters> thrusters_A = {};
  std::array<double, kLamps> lamps_A = {};
  double electronics_A = 0.0;
};
using LoadsFunction = std::function<ElectricLoads(double time_s)>;

/// Names of the measured channels: the thrusters, the lamps, and the battery, which carries their sum and the
/// current of the electronics.
const std::vector<std::string>& currentChannels();

/// Currents of the channels, A.
std::vector<double> channelCurrents(const ElectricLoads& loads);

/// Loads of a vehicle under way: thrusters as the motion needs, lamps that are switched on after the start
/// and off and on again for minutes, electronics of about 1.5 A.
LoadsFunction drawVehicleLoads(std::shared_ptr<const VehicleThrust> thrust, double duration_s, uint64_t seed);

/// Draws k_i of each channel in axes of the magnetometer's readings, T/A. Thrusters at 15 cm make 6 to 12 uT
/// at 20 A, lamps 0.1 to 0.4 uT at 2 A; the wires of the battery are twisted. Where the cables have moved,
/// each k_i turns by 30 to 70 degrees and changes its size by up to a half.
std::vector<Vec3> drawCurrentFields(uint64_t seed, bool cables_moved);

/// Sum of k_i I_i, T.
Vec3 fieldOfCurrents(const std::vector<Vec3>& fields_T_per_A, const std::vector<double>& currents_A);

/// Errors of the current sensors.
struct CurrentSensorErrors {
  double noise_A = 0.0;
  double resolution_A = 0.0;  ///< 0: continuous
};
constexpr CurrentSensorErrors kCurrentSensor{0.02, 0.01};  ///< of a hall sensor with 12 bits

class CurrentSensorModel {
 public:
  CurrentSensorModel(LoadsFunction loads, const CurrentSensorErrors& errors, uint64_t seed);

  /// Readings of all channels, A.
  std::vector<double> measure(double time_s);

 private:
  LoadsFunction loads_;
  CurrentSensorErrors errors_;
  Random noise_;
};

}  // namespace lodeline

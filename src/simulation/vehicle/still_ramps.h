#pragma once

#include <vector>

#include "lodeline/rig.h"
#include "simulation/sensors/magnetometer_model.h"
#include "simulation/vehicle/vehicle_currents.h"

namespace lodeline {

/// Times of a still test of currents: the vehicle rests, and the current of each channel rises and falls, one
/// channel after another. The channel of the battery is that of the electronics.
struct RampTimes {
  double before_s = 5.0;  ///< without ramps, at the start
  double ramp_s = 4.0;    ///< from zero to the largest current, and back
  double hold_s = 2.0;    ///< at the largest current
  double pause_s = 2.0;   ///< between two channels

  double each_s() const { return 2.0 * ramp_s + hold_s + pause_s; }
  double duration_s() const;
};

/// Loads of the test: thrusters to 20 A, lamps to 2 A, electronics from 1.5 to 4.5 A.
LoadsFunction rampedLoads(const RampTimes& times = {});

struct StillRampsOptions {
  uint64_t seed = 1;  ///< of cables, sensors, attitude and noise
  bool cables_moved = false;
  bool noise = true;
  RampTimes times;
  std::string_view imu_grade = "consumer";
  Vec3 field_W = Vec3(0.0, 24e-6, -38e-6);  ///< the Earth's, T
  double imu_rate_hz = 100.0;
  double magnetometer_rate_hz = 50.0;
  double current_rate_hz = 10.0;
  Time start = Time::fromNanoseconds(1'800'000'000'000'000'000);
};

/// Readings of a still test, with the truth.
struct StillRamps {
  std::vector<ImuSample> imu;
  std::vector<MagnetometerSample> magnetometer;
  std::vector<CurrentSample> currents;

  CurrentCalibration true_currents;  ///< channels and k_i
  MagnetometerErrors magnetometer_errors;
  Rigid3 world_from_body;
};

StillRamps simulateStillRamps(const StillRampsOptions& options);

}  // namespace lodeline

#pragma once

#include <optional>

#include "simulation/dive/scenario.h"
#include "simulation/rendering/optics/flat_port.h"
#include "simulation/sensors/imu_model.h"
#include "simulation/sensors/magnetometer_model.h"
#include "simulation/sensors/pressure_model.h"
#include "simulation/sensors/sensor_clock.h"
#include "simulation/sensors/sonar_model.h"

namespace lodeline {

/// The rig as it is, the rig as its files describe it, and every error of its sensors.
struct DiveErrors {
  MountedRig truth;              ///< behind a flat port the cameras are those in air
  Rig in_water;                  ///< truth as seen from the water: without a port the same, else the best fit
  Rig given;                     ///< what the calibration files say
  std::optional<FlatPort> port;  ///< in front of every camera
  double port_fit_rms_px = 0.0;  ///< what a radial-tangential model cannot express

  ImuErrors imu;
  MagnetometerErrors magnetometer;
  PressureErrors pressure;
  SonarErrors sonar;
  ClockErrors camera_clock;  ///< one trigger for all cameras
  double dropped_image_share = 0.0;
};

/// Draws all errors that the scenario's effects switch on. Each draws from its own stream: switching one
/// leaves the others as they were. The rig's own errors (IMU, iron) depend on the seed and the grade alone,
/// so that `figure_eight` and `bench` with a dive's seed calibrate that dive's rig.
DiveErrors drawErrors(const Scenario& scenario);

}  // namespace lodeline

#pragma once

#include <optional>

#include "lodeline/simulation.h"
#include "simulation/rendering/optics/port_fit.h"
#include "simulation/sensors/dvl_model.h"
#include "simulation/sensors/imu_model.h"
#include "simulation/sensors/magnetometer_model.h"
#include "simulation/sensors/pressure_model.h"
#include "simulation/sensors/sensor_clock.h"
#include "simulation/sensors/sonar_model.h"
#include "simulation/vehicle/vehicle_currents.h"

namespace lodeline {

/// The true rig, the rig in the calibration files, and all errors of its sensors.
struct DiveErrors {
  MountedRig truth;  ///< behind a port, the cameras are those in air
  Rig in_water;  ///< effective rig in water: the true rig, with a port the best fit to it or the port itself
  Rig given;     ///< content of the calibration files
  std::optional<PortWindow> port;  ///< in front of every camera
  double port_fit_rms_px = 0.0;    ///< residual that a radial-tangential model cannot represent

  ImuErrors imu;
  MagnetometerErrors magnetometer;
  PressureErrors pressure;
  SonarErrors sonar;
  SonarErrors altimeter;               ///< of a vehicle, as the next two
  DvlErrors dvl;                       ///< its misalignment is that of truth.rig.dvl
  CurrentSensorErrors current_sensor;  ///< k_i are those of truth.rig.currents
  double readout_s = 0.0;              ///< of the rolling shutter of all cameras; 0: global
  ClockErrors camera_clock;            ///< one trigger for all cameras
  double dropped_image_share = 0.0;
};

/// Draws all errors that the scenario's effects switch on. Each error has its own random stream, so switching
/// one does not change the others. The rig's own errors (IMU, iron) depend only on the seed and the grade.
/// Therefore `figure_eight` and `bench` with a dive's seed calibrate that dive's rig.
DiveErrors drawErrors(const Scenario& scenario);

}  // namespace lodeline

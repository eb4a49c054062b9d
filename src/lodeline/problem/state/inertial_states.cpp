#include "lodeline/problem/state/inertial_states.h"

#include <algorithm>

#include "lodeline/factors/inertial_factor.h"

namespace lodeline {
namespace {

constexpr const char* kGyroscopeAxes = "imu.gyro_axes";
constexpr const char* kAccelerometerAxes = "imu.accel_axes";

std::optional<SensorAxes> valueOf(const ParameterBlock* axes) {
  if (!axes) return std::nullopt;
  return SensorAxes(axes->value.data());
}

}  // namespace

EstimatorOptions optionsFor(const Rig& rig, EstimatorOptions options) {
  options.check();
  ImuAxesOptions& axes = options.imu_axes;
  const bool is_calibrated = imu_axes::areCalibrated(rig.imu.noise);
  if (axes.uncalibrated_sigma > 0.0)
    axes.uncalibrated_sigma = rig.imu.noise.axes_sigma.value_or(axes.uncalibrated_sigma);
  if (is_calibrated || axes.gyroscope_sigma <= 0.0) axes.uncalibrated_sigma = 0.0;
  for (double* sigma : {&axes.gyroscope_sigma, &axes.accelerometer_sigma})
    if (*sigma > 0.0) *sigma = std::max(*sigma, axes.uncalibrated_sigma);
  if (is_calibrated && axes.gyroscope_sigma > 0.0 && axes.accelerometer_sigma > 0.0) {
    double& beside = options.preintegration.motion_noise.axis_error;
    beside = std::min(beside, axes.error_beside_states);
  }
  return options;
}

void addInertialStates(Window& window, const ImuAxesOptions& options) {
  const auto add = [&](const char* name, double sigma) {
    if (sigma <= 0.0) return;
    ParameterBlock state;
    state.name = name;
    state.value.assign(kSensorAxesSize, 0.0);
    window.add(std::move(state));
  };
  add(kGyroscopeAxes, options.gyroscope_sigma);
  add(kAccelerometerAxes, options.accelerometer_sigma);
}

ImuAxesStates::ImuAxesStates(const Window& window)
    : gyroscope(window.findGlobal(kGyroscopeAxes)), accelerometer(window.findGlobal(kAccelerometerAxes)) {}

std::optional<SensorAxes> gyroscopeAxes(const Window& window) {
  return valueOf(ImuAxesStates(window).gyroscope);
}

std::optional<SensorAxes> accelerometerAxes(const Window& window) {
  return valueOf(ImuAxesStates(window).accelerometer);
}

}  // namespace lodeline

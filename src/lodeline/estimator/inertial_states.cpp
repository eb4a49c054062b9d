#include "lodeline/estimator/inertial_states.h"

#include "lodeline/factors/inertial_factor.h"

namespace lodeline {
namespace {

constexpr const char* kGyroscopeAxes = "imu.gyro_axes";

}  // namespace

EstimatorOptions optionsFor(const Rig& rig, EstimatorOptions options) {
  ImuAxesOptions& axes = options.imu_axes;
  const bool is_calibrated =
      rig.imu.noise.gyroscope_density_rad_per_s_sqrtHz < axes.calibrated_below_rad_per_s_sqrtHz;
  if (is_calibrated || axes.gyroscope_sigma <= 0.0) axes.uncalibrated_sigma = 0.0;
  return options;
}

void addInertialStates(Window& window, const ImuAxesOptions& options) {
  if (options.gyroscope_sigma <= 0.0) return;
  GlobalState state;
  state.name = kGyroscopeAxes;
  state.value.assign(kGyroscopeAxesSize, 0.0);
  state.is_correlation_wanted = true;
  window.add(std::move(state));
}

GlobalState* gyroscopeAxesState(const Window& window) { return window.findGlobal(kGyroscopeAxes); }

std::optional<GyroscopeAxes> gyroscopeAxes(const Window& window) {
  const GlobalState* state = gyroscopeAxesState(window);
  if (!state) return std::nullopt;
  return GyroscopeAxes(state->value.data());
}

}  // namespace lodeline

#include "lodeline/estimator/inertial_states.h"

#include "lodeline/factors/inertial_factor.h"

namespace lodeline {
namespace {

constexpr const char* kGyroscopeAxes = "imu.gyro_axes";

}  // namespace

void addInertialStates(Window& window, const ImuNoise& noise, const ImuAxesOptions& options) {
  if (options.gyroscope_sigma <= 0.0) return;
  if (noise.gyroscope_density_rad_per_s_sqrtHz < options.calibrated_below_rad_per_s_sqrtHz) return;
  GlobalState state;
  state.name = kGyroscopeAxes;
  state.value.assign(kGyroscopeAxesSize, 0.0);
  window.add(std::move(state));
}

GlobalState* gyroscopeAxesState(const Window& window) { return window.findGlobal(kGyroscopeAxes); }

std::optional<GyroscopeAxes> gyroscopeAxes(const Window& window) {
  const GlobalState* state = gyroscopeAxesState(window);
  if (!state) return std::nullopt;
  return GyroscopeAxes(state->value.data());
}

}  // namespace lodeline

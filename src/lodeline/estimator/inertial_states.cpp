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
  state.is_correlation_wanted = true;
  window.add(std::move(state));
}

GlobalState* gyroscopeAxesState(const Window& window) { return window.findGlobal(kGyroscopeAxes); }

std::optional<GyroscopeAxes> gyroscopeAxes(const Window& window) {
  const GlobalState* state = gyroscopeAxesState(window);
  if (!state) return std::nullopt;
  return GyroscopeAxes(state->value.data());
}

Eigen::Matrix<double, 15, 15> claimedCovariance(const JointCovariance& known, const Window& window,
                                                const FactorMaker& factors, const ImuAxesOptions& options) {
  const auto belief = factors.gyroscopeAxes(window);
  if (!belief || options.uncalibrated_sigma <= 0.0) return known.newest();
  const double variance = options.uncalibrated_sigma * options.uncalibrated_sigma;
  NormalEquations believed;
  believed.add(*belief);
  const Eigen::MatrixXd left = Eigen::MatrixXd::Identity(kGyroscopeAxesSize, kGyroscopeAxesSize) / variance;
  Eigen::Matrix<double, 15, 15> claimed =
      known.newestWithout(belief->blocks.front(), believed.hessian() - left);
  claimed.diagonal().segment<2>(3).array() += variance;
  return claimed;
}

}  // namespace lodeline

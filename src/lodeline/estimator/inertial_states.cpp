#include "lodeline/estimator/inertial_states.h"

#include <Eigen/Eigenvalues>

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

std::optional<Eigen::MatrixXd> unclaimedInformation(const Window& window, const FactorMaker& factors,
                                                    const ImuAxesOptions& options) {
  const auto belief = factors.gyroscopeAxes(window);
  if (!belief || !options.areDoubted()) return std::nullopt;
  NormalEquations believed;
  believed.add(*belief);
  Eigen::MatrixXd information = believed.hessian();
  information.diagonal().array() -= 1.0 / (options.uncalibrated_sigma * options.uncalibrated_sigma);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> parts(information);
  return parts.eigenvectors() * parts.eigenvalues().cwiseMax(0.0).asDiagonal() *
         parts.eigenvectors().transpose();
}

void addDoubtAboutUp(const ImuAxesOptions& options, Eigen::Matrix<double, 15, 15>* covariance) {
  covariance->diagonal().segment<2>(3).array() += options.accelerometerSigma() * options.accelerometerSigma();
}

Eigen::Matrix<double, 15, 15> claimedCovariance(const JointCovariance& known, const Window& window,
                                                const FactorMaker& factors, const ImuAxesOptions& options) {
  const auto unclaimed = unclaimedInformation(window, factors, options);
  Eigen::Matrix<double, 15, 15> claimed =
      unclaimed ? known.newestWithout(gyroscopeAxesState(window)->value.data(), *unclaimed) : known.newest();
  addDoubtAboutUp(options, &claimed);
  return claimed;
}

}  // namespace lodeline

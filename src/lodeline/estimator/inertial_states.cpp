#include "lodeline/estimator/inertial_states.h"

#include <Eigen/Eigenvalues>

#include "lodeline/estimator/lens_trust.h"
#include "lodeline/factors/inertial_factor.h"

namespace lodeline {
namespace {

constexpr const char* kGyroscopeAxes = "imu.gyro_axes";

/// What of the start's information about the accelerometer's bias its present covariance can have: the bias
/// walks, and no direction of it is to be claimed worse than the start's sigma, `sigma_m_per_s2`.
Eigen::MatrixXd biasInformation(const Mat3& known, double unclaimed, double sigma_m_per_s2) {
  const Eigen::SelfAdjointEigenSolver<Mat3> parts(known);
  const Vec3 left = parts.eigenvalues().cwiseInverse().array() - 1.0 / (sigma_m_per_s2 * sigma_m_per_s2);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(kMotionSize, kMotionSize);
  information.bottomRightCorner<3, 3>() = parts.eigenvectors() *
                                          left.cwiseMin(unclaimed).cwiseMax(0.0).asDiagonal() *
                                          parts.eigenvectors().transpose();
  return information;
}

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

double unclaimedBiasInformation(const EstimatorOptions& options) {
  if (!options.imu_axes.areDoubted()) return 0.0;
  const double used = options.initial_state.accelerometer_bias_sigma_m_per_s2;
  const double claimed = options.imu_axes.uncalibrated_bias_sigma_m_per_s2;
  return claimed > used ? 1.0 / (used * used) - 1.0 / (claimed * claimed) : 0.0;
}

void addDoubtAboutUp(const ImuAxesOptions& options, Eigen::Matrix<double, 15, 15>* covariance) {
  covariance->diagonal().segment<2>(3).array() += options.accelerometerSigma() * options.accelerometerSigma();
}

Eigen::Matrix<double, 15, 15> claimedCovariance(const JointCovariance& known, const Window& window,
                                                const FactorMaker& factors, const EstimatorOptions& options) {
  const ImuAxesOptions& axes = options.imu_axes;
  JointCovariance claimed = known;
  for (const auto& [lens, unclaimed] : unclaimedFileInformation(window, options.camera_calibration)) {
    if (claimed.knows(lens)) claimed = claimed.without(lens, unclaimed);
  }
  if (const auto unclaimed = unclaimedInformation(window, factors, axes))
    claimed = claimed.without(gyroscopeAxesState(window)->value.data(), *unclaimed);
  if (const double unclaimed = unclaimedBiasInformation(options); unclaimed > 0.0) {
    const double* motion = window.newest().motion.data();
    claimed = claimed.without(motion, biasInformation(claimed.newest().bottomRightCorner<3, 3>(), unclaimed,
                                                      axes.uncalibrated_bias_sigma_m_per_s2));
  }
  Eigen::Matrix<double, 15, 15> newest = claimed.newest();
  addDoubtAboutUp(axes, &newest);
  return newest;
}

}  // namespace lodeline

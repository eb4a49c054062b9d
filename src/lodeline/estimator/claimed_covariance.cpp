#include "lodeline/estimator/claimed_covariance.h"

#include <Eigen/Eigenvalues>

#include "lodeline/estimator/lens_trust.h"

namespace lodeline {
namespace {

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
                                                const EstimatorOptions& options) {
  const ImuAxesOptions& axes = options.imu_axes;
  JointCovariance claimed = known;
  for (const auto& [state, unclaimed] : unclaimedFileInformation(window, options.camera_calibration)) {
    if (claimed.knows(state)) claimed = claimed.without(state, unclaimed);
  }
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

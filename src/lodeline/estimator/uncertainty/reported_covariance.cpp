#include "lodeline/estimator/uncertainty/reported_covariance.h"

#include <Eigen/Eigenvalues>
#include <optional>

#include "lodeline/estimator/self_calibration/intrinsics_model_selection.h"
#include "lodeline/problem/state/camera_states.h"

namespace lodeline {
namespace {

/// The part of the initial information on the accelerometer bias that its present covariance can still
/// contain. The bias walks, so that part may be smaller than `removed`. In no direction does the reported
/// sigma exceed the initial one, `sigma_m_per_s2`.
Eigen::MatrixXd biasInformation(const Mat3& known, double removed, double sigma_m_per_s2) {
  const Eigen::SelfAdjointEigenSolver<Mat3> parts(known);
  const Vec3 left = parts.eigenvalues().cwiseInverse().array() - 1.0 / (sigma_m_per_s2 * sigma_m_per_s2);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(kMotionSize, kMotionSize);
  information.bottomRightCorner<3, 3>() = parts.eigenvectors() *
                                          left.cwiseMin(removed).cwiseMax(0.0).asDiagonal() *
                                          parts.eigenvectors().transpose();
  return information;
}

/// Information to remove from a secondary camera's extrinsics. The used information is that after the robust
/// loss, which is small for a camera found at another position.
Eigen::MatrixXd removedExtrinsics(const Factor& placement, double baseline_m) {
  const double reported_sigma_m = kBaselineTolerance * baseline_m;
  NormalEquations used;
  used.add(placement);
  Eigen::MatrixXd information = used.hessian();
  auto of_position = information.diagonal().tail<3>().array();
  of_position = (of_position - 1.0 / (reported_sigma_m * reported_sigma_m)).max(0.0);
  return information;
}

}  // namespace

double removedBiasInformation(const EstimatorOptions& options) {
  if (!options.imu_axes.areDoubted()) return 0.0;
  const double used = options.initial_state.accelerometer_bias_sigma_m_per_s2;
  const double claimed = options.imu_axes.uncalibrated_bias_sigma_m_per_s2;
  return claimed > used ? 1.0 / (used * used) - 1.0 / (claimed * claimed) : 0.0;
}

void addDoubtAboutUp(const ImuAxesOptions& options, Eigen::Matrix<double, 15, 15>* covariance) {
  covariance->diagonal().segment<2>(3).array() += options.accelerometerSigma() * options.accelerometerSigma();
}

std::vector<std::pair<const double*, Eigen::MatrixXd>> removedCalibration(const Window& window,
                                                                          const EstimatorOptions& options,
                                                                          const FactorBuilder& factors) {
  auto removed = removedFileInformation(window, options.camera_calibration);
  const CameraStates states = cameraStates(window);
  for (size_t i = 0; i < states.secondary.size(); ++i) {
    ParameterBlock& secondary = *states.secondary[i];
    const std::optional<Factor> placement = factors.placement(secondary);
    const double baseline_m = factors.camera0FromCamera(static_cast<int>(i) + 1).translation.norm();
    if (placement && baseline_m > 0.0)
      removed.emplace_back(secondary.value.data(), removedExtrinsics(*placement, baseline_m));
  }
  return removed;
}

Eigen::Matrix<double, 15, 15> reportedCovariance(const JointCovariance& known, const Window& window,
                                                 const EstimatorOptions& options,
                                                 const FactorBuilder& factors) {
  const ImuAxesOptions& axes = options.imu_axes;
  JointCovariance claimed = known;
  for (const auto& [state, removed] : removedCalibration(window, options, factors)) {
    if (claimed.knows(state)) claimed = claimed.without(state, removed);
  }
  if (const double removed = removedBiasInformation(options); removed > 0.0) {
    const double* motion = window.newest().motion.data();
    claimed = claimed.without(motion, biasInformation(claimed.newest().bottomRightCorner<3, 3>(), removed,
                                                      axes.uncalibrated_bias_sigma_m_per_s2));
  }
  Eigen::Matrix<double, 15, 15> newest = claimed.newest();
  addDoubtAboutUp(axes, &newest);
  return newest;
}

}  // namespace lodeline

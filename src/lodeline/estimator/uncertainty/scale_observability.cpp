#include "lodeline/estimator/uncertainty/scale_observability.h"

#include <algorithm>
#include <cmath>

#include "lodeline/estimator/self_calibration/intrinsics_model_selection.h"
#include "lodeline/estimator/visual/landmarks.h"
#include "lodeline/problem/state/camera_states.h"
#include "lodeline/problem/state/inertial_states.h"

namespace lodeline {
namespace {

constexpr double kMemory_s = 30.0;
// Relative sigma of errors that no file states: the scale of an accelerometer triad (0.05 to 1 % by their
// makers), the length of a baseline that counts as exact.
constexpr double kUnstated = 1e-3;

/// Information after the addition of an unstated error of the scale.
double trusted(double information, double unstated) {
  return information > 0.0 ? 1.0 / (1.0 / information + unstated * unstated) : 0.0;
}

}  // namespace

void ScaleObservability::Scatter::fade(double keep) {
  weight_ *= keep;
  squares_ *= keep;
}

void ScaleObservability::Scatter::add(const Vec3& value, double weight) {
  weight_ += weight;
  const Vec3 before = value - mean_;
  mean_ += weight / weight_ * before;
  squares_ += weight * before.dot(value - mean_);
}

double ScaleObservability::Scatter::sum() const { return squares_; }

ScaleObservability::ScaleObservability(const Rig& rig, const EstimatorOptions& options)
    : calibration_(options.camera_calibration), imu_axes_(options.imu_axes) {
  if (rig.dvl) dvl_scale_sigma_ = rig.dvl->scale_sigma;
  if (rig.cameras.size() < 2) return;
  baseline_m_ =
      (rig.cameras[1].body_from_camera.translation - rig.cameras[0].body_from_camera.translation).norm();
}

ScaleInformation ScaleObservability::add(const Window& window, double density_sigma,
                                         const Mat3& velocity_covariance_W) {
  const Frame& newest = window.newest();
  if (last_) {
    const double keep = std::exp(-(newest.time - *last_).seconds() / kMemory_s);
    accelerations_.fade(keep);
    heights_.fade(keep);
    speeds_ *= keep;
  }
  last_ = newest.time;
  if (newest.from_previous && window.frames().size() > 1) {
    const Frame& before = *window.frames()[window.frames().size() - 2];
    const double elapsed_s = newest.from_previous->dt_s();
    const double speed_variance =
        (newest.from_previous->covariance().block<3, 3>(3, 3) + velocity_covariance_W).trace() / 3.0;
    const Vec3 acceleration_W = (newest.velocity_W() - before.velocity_W()) / elapsed_s;
    if (std::isfinite(speed_variance))  // not so where the covariance is lost in rounding
      accelerations_.add(acceleration_W, elapsed_s * elapsed_s / speed_variance);
  }
  for (const auto& measurement : newest.measurements) {
    speeds_ += measurement->speedInformation();
    if (const auto sigma_m = measurement->heightSigma_m())
      heights_.add(newest.worldFromBody().translation.z() * Vec3::UnitZ(), 1.0 / std::pow(*sigma_m, 2));
  }
  ScaleInformation information;
  information.stereo = stereoInformation(window);
  information.accelerometer =
      trusted(accelerations_.sum(), std::max(kUnstated, imu_axes_.uncalibrated_sigma));
  if (heights_.sum() > 0.0) information.depth = 1.0 / (1.0 / heights_.sum() + density_sigma * density_sigma);
  information.dvl = trusted(speeds_, std::hypot(kUnstated, dvl_scale_sigma_));
  return information;
}

double ScaleObservability::stereoInformation(const Window& window) const {
  if (!baseline_m_) return 0.0;
  const std::optional<double> distance_m = meanLandmarkDistance_m(window, window.newest().id, 1);
  if (!distance_m) return 0.0;
  double position_sigma_m = calibration_.enabled ? calibration_.stereo_position_sigma_m : 0.0;
  double rotation_sigma_rad = calibration_.enabled ? calibration_.stereo_rotation_sigma_rad : 0.0;
  const CameraStates states = cameraStates(window);
  if (!states.secondary.empty()) {
    const ParameterBlock& secondary = *states.secondary.front();
    if (!secondary.priors.empty()) rotation_sigma_rad *= kFileTolerance;
    const double found_m = Eigen::Map<const Vec3>(secondary.value.data() + 3).norm();
    // The weight from the loss is 1 / (1 + (x / width)^2).
    if (position_sigma_m > 0.0)
      position_sigma_m = std::hypot(position_sigma_m, found_m / placementLossWidth(secondary));
  }
  const double by_position = position_sigma_m / *baseline_m_;
  const double by_rotation = rotation_sigma_rad * *distance_m / *baseline_m_;
  return 1.0 / (by_position * by_position + by_rotation * by_rotation + kUnstated * kUnstated);
}

}  // namespace lodeline

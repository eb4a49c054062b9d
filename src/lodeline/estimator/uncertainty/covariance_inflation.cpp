#include "lodeline/estimator/uncertainty/covariance_inflation.h"

#include <algorithm>
#include <cmath>

#include "lodeline/geometry/so3.h"

namespace lodeline {

double unmodelledDensitySigma(const EstimatorOptions& options) {
  if (!options.camera_calibration.enabled) return 0.0;
  // A density stated more accurately than that gains nothing from images.
  return std::min(options.depth.least_density_sigma, options.depth.density_ratio_sigma);
}

void CovarianceInflation::follow(const Rigid3& world_from_body, std::optional<double> scene_distance_m) {
  scene_distance_m_ = scene_distance_m.value_or(scene_distance_m_);
  if (newest_) {
    const Rigid3 step = newest_->inverse() * world_from_body;
    const Mat3 world_from_newest = newest_->rotation.toRotationMatrix();
    const Vec3 turn = so3::log(step.rotation);
    for (int k = 0; k < 3; ++k) {
      by_way_[k] += step.translation[k] * world_from_newest;
      by_turn_[k] += scene_distance_m_ * turn[k] * world_from_newest;
    }
    const Vec3 step_W = world_from_body.translation - newest_->translation;
    bent_by_turns_.follow(turn, world_from_newest, step_W);
    bent_by_the_way_.follow(step.translation, world_from_newest, step_W);
  }
  newest_ = world_from_body;
}

void CovarianceInflation::Bend::follow(const Vec3& cause_B, const Mat3& world_from_body, const Vec3& step_W) {
  x -= step_W.y() * heading;
  y += step_W.x() * heading;
  heading += world_from_body.row(2).transpose() * cause_B.transpose();
}

void CovarianceInflation::addTo(const EstimateSources& sources,
                                Eigen::Matrix<double, 15, 15>* covariance) const {
  const Eigen::Matrix<double, 6, Eigen::Dynamic> of_pose = root(sources);
  covariance->topLeftCorner<6, 6>() += of_pose * of_pose.transpose();
}

Eigen::Matrix<double, 6, Eigen::Dynamic> CovarianceInflation::root(const EstimateSources& sources) const {
  Eigen::Matrix<double, 6, Eigen::Dynamic> root = Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, kErrors);
  if (!options_.camera_calibration.enabled || !newest_) return root;
  const Vec3& position_W = newest_->translation;
  for (int k = 0; k < 3; ++k) {
    root.block<3, 3>(0, 3 * k) = kWayPerWaySigma * by_way_[k];
    root.block<3, 3>(0, 9 + 3 * k) = kWayPerTurnSigma * by_turn_[k];
  }
  if (!sources.is_scale_given) root.block<3, 1>(0, 18) = kOneCameraScaleSigma * position_W;
  if (sources.density_sigma) {
    root.row(2) *= std::min(1.0, kHeldHeightSigma_m / std::max(root.row(2).norm(), 1e-6));
    root(2, 19) = *sources.density_sigma * position_W.z();
  }
  if (sources.has_magnetometer) return root;
  const auto addBend = [&](int column, double sigma, const Bend& bend) {
    root.block<1, 9>(0, column) = sigma * bend.x.reshaped().transpose();
    root.block<1, 9>(1, column) = sigma * bend.y.reshaped().transpose();
    root.block<1, 9>(5, column) = sigma * bend.heading.reshaped().transpose();
  };
  addBend(20, sources.are_gyroscope_axes_known ? kHeldTurnPerTurnSigma : kTurnPerTurnSigma, bent_by_turns_);
  if (!sources.is_scale_given) addBend(29, kTurnPerWaySigma_rad_per_m, bent_by_the_way_);
  return root;
}

void addHeadingError(double sigma_rad, const NavigationState& state,
                     Eigen::Matrix<double, 15, 15>* covariance) {
  Eigen::Matrix<double, 9, 1> moved;
  moved << Vec3::UnitZ().cross(state.world_from_body.translation), Vec3::UnitZ(),
      Vec3::UnitZ().cross(state.velocity_W);
  covariance->topLeftCorner<9, 9>() += sigma_rad * sigma_rad * moved * moved.transpose();
}

}  // namespace lodeline

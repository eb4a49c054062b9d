#include "lodeline/estimator/dvl/dvl_factor.h"

#include <fmt/core.h>

#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

/// The blocks' values, and what follows from them.
struct DvlState {
  Mat3 body_from_world;
  Vec3 velocity_W, gyroscope_bias, accelerometer_bias, misalignment;
  double scale;
  Vec3 unfallen_W;  ///< v - g elapsed, through the water v - c - g elapsed
  Vec3 turned;      ///< gamma R^T unfallen_W
  Vec3 shown_D;     ///< exp(m)^T R_BD^T (u + (w - b_g) x p_BD)

  /// `current_block`: null over the bottom.
  DvlState(const DvlGeometry& geometry, const double* pose, const double* motion, const double* scale_block,
           const double* misalignment_block, const double* current_block)
      : body_from_world(poseFromBlock(pose).rotation.toRotationMatrix().transpose()),
        velocity_W(motion),
        gyroscope_bias(motion + 3),
        accelerometer_bias(motion + 6),
        misalignment(misalignment_block),
        scale(1.0 + scale_block[0]) {
    const PingMotion& ping = geometry.motion;
    unfallen_W = velocity_W - ping.elapsed_s * geometry.gravity_W;
    if (current_block != nullptr) unfallen_W -= Vec3(current_block);
    turned = ping.rotationFor(gyroscope_bias) * (body_from_world * unfallen_W);
    const Vec3 instrument_B = turned - ping.velocityChangeFor(gyroscope_bias, accelerometer_bias) +
                              (ping.rate_B - gyroscope_bias).cross(geometry.body_from_dvl.translation);
    shown_D =
        so3::exp(misalignment).conjugate() * (geometry.body_from_dvl.rotation.conjugate() * instrument_B);
  }
};

}  // namespace

DvlFactor::DvlFactor(const Vec3& direction_D, double velocity_m_per_s, double sigma_m_per_s,
                     const DvlGeometry& geometry, const DvlLinearizationPoints& linearization_points)
    : direction_D_(direction_D),
      velocity_(velocity_m_per_s),
      sigma_(sigma_m_per_s),
      geometry_(geometry),
      first_(linearization_points) {
  if (!direction_D.allFinite() || !std::isfinite(velocity_m_per_s) || !(sigma_m_per_s > 0.0) ||
      !std::isfinite(sigma_m_per_s)) {
    throw InputError(fmt::format("a velocity of {} m/s with sigma {} m/s cannot be weighed", velocity_m_per_s,
                                 sigma_m_per_s));
  }
  set_num_residuals(1);
  *mutable_parameter_block_sizes() = {kPoseSize, kMotionSize, 1, kMisalignmentSize};
  if (isThroughWater()) mutable_parameter_block_sizes()->push_back(kWaterCurrentSize);
}

bool DvlFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const DvlState now(geometry_, parameters[0], parameters[1], parameters[2], parameters[3],
                     isThroughWater() ? parameters[4] : nullptr);
  residuals[0] = (now.scale * direction_D_.dot(now.shown_D) - velocity_) / sigma_;
  if (jacobians == nullptr) return true;

  const auto at = [&](const double* first, int block) {
    return first != nullptr ? first : parameters[block];
  };
  const DvlState state(geometry_, at(first_.pose, 0), at(first_.motion, 1), at(first_.scale, 2),
                       at(first_.misalignment, 3), isThroughWater() ? at(first_.current, 4) : nullptr);
  const PingMotion& ping = geometry_.motion;
  const Eigen::RowVector3d by_shown = state.scale / sigma_ * direction_D_.transpose();
  const Eigen::RowVector3d by_instrument_B =
      by_shown * (so3::exp(state.misalignment).conjugate() * geometry_.body_from_dvl.rotation.conjugate())
                     .toRotationMatrix();
  const Eigen::RowVector3d by_unfallen_W =
      by_instrument_B * ping.rotationFor(state.gyroscope_bias).toRotationMatrix() * state.body_from_world;
  if (jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 1, kPoseSize>> by_pose(jacobians[0]);
    by_pose << Eigen::RowVector3d::Zero(), by_unfallen_W * so3::skew(state.unfallen_W), 0.0;
  }
  if (jacobians[1] != nullptr) {
    const Vec3 turn = ping.rotation_by_gyroscope_bias * (state.gyroscope_bias - ping.gyroscope_bias_B);
    const Mat3 by_gyroscope_bias =
        -so3::skew(state.turned) * so3::leftJacobian(turn) * ping.rotation_by_gyroscope_bias -
        ping.velocity_by_gyroscope_bias + so3::skew(geometry_.body_from_dvl.translation);
    Eigen::Map<Eigen::Matrix<double, 1, kMotionSize>> by_motion(jacobians[1]);
    by_motion << by_unfallen_W, by_instrument_B * by_gyroscope_bias,
        -by_instrument_B * ping.velocity_by_accelerometer_bias;
  }
  if (jacobians[2] != nullptr) jacobians[2][0] = direction_D_.dot(state.shown_D) / sigma_;
  if (jacobians[3] != nullptr) {
    Eigen::Map<Eigen::RowVector3d> by_misalignment(jacobians[3]);
    by_misalignment = by_shown * so3::skew(state.shown_D) * so3::rightJacobian(state.misalignment);
  }
  if (isThroughWater() && jacobians[4] != nullptr) {
    Eigen::Map<Eigen::RowVector3d> by_current(jacobians[4]);
    by_current = -by_unfallen_W;
  }
  return true;
}

}  // namespace lodeline

#include "lodeline/factors/calibrated_reprojection_factor.h"

#include "lodeline/factors/parameters.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

enum Block { kHost, kTarget, kPoint, kCamera0, kTimeOffset, kTargetCamera };

template <int Cols>
using RowMajor2 = Eigen::Matrix<double, 2, Cols, Eigen::RowMajor>;

/// d(q) / d[phi, xi] of a secondary camera, for the homogeneous point q_0 in camera 0.
Eigen::Matrix<double, 3, 6> byFurtherExtrinsics(const Rigid3& camera0_from_target, const double* correction,
                                                const Vec3& point_C0, double rho) {
  const Mat3 target_rotation = camera0_from_target.rotation.conjugate().toRotationMatrix();
  Eigen::Matrix<double, 3, 6> derivative;
  derivative << target_rotation * so3::skew(point_C0 - rho * camera0_from_target.translation) *
                    so3::leftJacobian(Vec3(correction)),
      -rho * target_rotation;
  return derivative;
}

}  // namespace

Rigid3 correctedExtrinsics(const Rigid3& nominal, const double* correction) {
  return {so3::exp(Vec3(correction)) * nominal.rotation, nominal.translation + Vec3(correction + 3)};
}

Rigid3 ImageMotion::poseAfter(const Rigid3& world_from_body, double dt_s) const {
  return {world_from_body.rotation * so3::exp(angular_velocity_B * dt_s),
          world_from_body.translation + velocity_W * dt_s};
}

/// Intermediate values from landmark to target camera at one set of blocks, as the Jacobians need them.
struct CalibratedReprojectionFactor::Chain {
  Mat3 host_rotation, target_rotation;  // world from body, at the true times of the images
  Mat3 target_from_host;                // body to body
  Mat3 camera0_rotation;                // body from camera 0
  Mat3 camera_from_body;                // of the target camera
  Rigid3 camera0_from_target;
  Vec3 camera0_position;
  Vec3 direction_B;  // R_0 d, axes of the host body
  Vec3 between_W;    // p_h - p_t
  Vec3 host_arm_W;   // R_h (R_0 d + rho p_0)
  Vec3 point_B;      // m
  Vec3 point_C0;     // q_0
  Vec3 point_C;      // q

  Chain(const CalibratedReprojectionFactor& factor, double const* const* blocks) {
    const double* landmark = blocks[kPoint];
    const double rho = landmark[2];
    const double dt_s = blocks[kTimeOffset][0];
    const Rigid3 host = factor.host_motion_.poseAfter(poseFromBlock(blocks[kHost]), dt_s);
    const Rigid3 target = factor.target_motion_.poseAfter(poseFromBlock(blocks[kTarget]), dt_s);
    const Rigid3 camera0 = correctedExtrinsics(factor.placement_.body_from_camera0, blocks[kCamera0]);
    host_rotation = host.rotation.toRotationMatrix();
    target_rotation = target.rotation.toRotationMatrix();
    target_from_host = target_rotation.transpose() * host_rotation;
    camera0_rotation = camera0.rotation.toRotationMatrix();
    camera0_position = camera0.translation;
    direction_B = camera0_rotation * factor.base_.direction(landmark);
    between_W = host.translation - target.translation;
    host_arm_W = host_rotation * (direction_B + rho * camera0_position);
    point_B = target_rotation.transpose() * (host_arm_W + rho * between_W) - rho * camera0_position;
    point_C0 = camera0_rotation.transpose() * point_B;
    point_C = point_C0;
    camera_from_body = camera0_rotation.transpose();
    if (!factor.placement_.camera0_from_target) return;
    camera0_from_target = correctedExtrinsics(*factor.placement_.camera0_from_target, blocks[kTargetCamera]);
    const Mat3 target_from_camera0 = camera0_from_target.rotation.toRotationMatrix().transpose();
    point_C = target_from_camera0 * (point_C0 - rho * camera0_from_target.translation);
    camera_from_body = target_from_camera0 * camera_from_body;
  }
};

CalibratedReprojectionFactor::CalibratedReprojectionFactor(
    const DirectionMeasurement& measurement, const LandmarkBase& base, const CameraPlacement& placement,
    const ImageMotion& host_motion, const ImageMotion& target_motion,
    const CalibratedLinearizationPoints& linearization_points)
    : measurement_(measurement),
      base_(base),
      placement_(placement),
      host_motion_(host_motion),
      target_motion_(target_motion),
      linearization_points_(linearization_points) {
  set_num_residuals(2);
  *mutable_parameter_block_sizes() = {kPoseSize, kPoseSize, kLandmarkSize, kExtrinsicsSize, kTimeOffsetSize};
  if (placement_.camera0_from_target) mutable_parameter_block_sizes()->push_back(kExtrinsicsSize);
}

bool CalibratedReprojectionFactor::Evaluate(double const* const* parameters, double* residuals,
                                            double** jacobians) const {
  Chain chain(*this, parameters);
  Mat23 by_point;
  Eigen::Map<Vec2> residual(residuals);
  const double rho = parameters[kPoint][2];
  residual = directionResidual(measurement_, measurement_.fromOrigin(chain.point_C, rho),
                               jacobians ? &by_point : nullptr);
  if (!jacobians) return true;

  const CalibratedLinearizationPoints& first = linearization_points_;
  if (first.host || first.target || first.camera0 || first.time_offset || first.target_camera) {
    const double* at[] = {first.host ? first.host : parameters[kHost],
                          first.target ? first.target : parameters[kTarget],
                          parameters[kPoint],
                          first.camera0 ? first.camera0 : parameters[kCamera0],
                          first.time_offset ? first.time_offset : parameters[kTimeOffset],
                          nullptr};
    if (placement_.camera0_from_target)
      at[kTargetCamera] = first.target_camera ? first.target_camera : parameters[kTargetCamera];
    chain = Chain(*this, at);
    directionResidual(measurement_, measurement_.fromOrigin(chain.point_C, rho), &by_point);
  }
  const Mat23 by_body = by_point * chain.camera_from_body;
  const Mat23 by_world = by_body * chain.target_rotation.transpose();
  const Mat23 by_host_turn = -by_world * so3::skew(chain.host_arm_W);
  const Mat23 by_target_turn = by_world * so3::skew(chain.host_arm_W + rho * chain.between_W);
  if (jacobians[kHost]) {
    Eigen::Map<RowMajor2<kPoseSize>>(jacobians[kHost]) << rho * by_world, by_host_turn, Vec2::Zero();
  }
  if (jacobians[kTarget]) {
    Eigen::Map<RowMajor2<kPoseSize>>(jacobians[kTarget]) << -rho * by_world, by_target_turn, Vec2::Zero();
  }
  if (jacobians[kPoint]) {
    Vec3 body_by_rho = chain.target_from_host * chain.camera0_position +
                       chain.target_rotation.transpose() * chain.between_W - chain.camera0_position;
    if (placement_.camera0_from_target)
      body_by_rho -= chain.camera0_rotation * chain.camera0_from_target.translation;
    Eigen::Map<RowMajor2<kLandmarkSize>>(jacobians[kPoint])
        << by_body * chain.target_from_host * chain.camera0_rotation * base_.tangent_C,
        by_body * body_by_rho - by_point * measurement_.origin_C;
  }
  if (jacobians[kCamera0]) {
    const double* correction = first.camera0 ? first.camera0 : parameters[kCamera0];
    Eigen::Map<RowMajor2<kExtrinsicsSize>>(jacobians[kCamera0])
        << by_body * (so3::skew(chain.point_B) - chain.target_from_host * so3::skew(chain.direction_B)) *
               so3::leftJacobian(Vec3(correction)),
        rho * by_body * (chain.target_from_host - Mat3::Identity());
  }
  if (jacobians[kTimeOffset]) {
    Eigen::Map<Vec2> by_time(jacobians[kTimeOffset]);
    by_time = rho * by_world * (host_motion_.velocity_W - target_motion_.velocity_W) +
              by_host_turn * chain.host_rotation * host_motion_.angular_velocity_B +
              by_target_turn * chain.target_rotation * target_motion_.angular_velocity_B;
  }
  if (placement_.camera0_from_target && jacobians[kTargetCamera]) {
    const double* correction = first.target_camera ? first.target_camera : parameters[kTargetCamera];
    Eigen::Map<RowMajor2<kExtrinsicsSize>> by_camera(jacobians[kTargetCamera]);
    by_camera = by_point * byFurtherExtrinsics(chain.camera0_from_target, correction, chain.point_C0, rho);
  }
  return true;
}

CalibratedStereoFactor::CalibratedStereoFactor(const DirectionMeasurement& measurement,
                                               const LandmarkBase& base, const Rigid3& camera0_from_target,
                                               const double* linearization_point)
    : measurement_(measurement),
      base_(base),
      camera0_from_target_(camera0_from_target),
      linearization_point_(linearization_point) {}

bool CalibratedStereoFactor::Evaluate(double const* const* parameters, double* residuals,
                                      double** jacobians) const {
  const double* landmark = parameters[0];
  const double* correction = parameters[1];
  const double rho = landmark[2];
  const Vec3 point_C0 = base_.direction(landmark);
  const auto seen = [&](const Rigid3& camera0_from_target) {
    const Vec3 point_C =
        camera0_from_target.rotation.conjugate() * (point_C0 - rho * camera0_from_target.translation);
    return measurement_.fromOrigin(point_C, rho);
  };
  Rigid3 camera0_from_target = correctedExtrinsics(camera0_from_target_, correction);
  Mat23 by_point;
  Eigen::Map<Vec2> residual(residuals);
  residual = directionResidual(measurement_, seen(camera0_from_target), jacobians ? &by_point : nullptr);
  if (!jacobians) return true;
  if (linearization_point_) {
    correction = linearization_point_;
    camera0_from_target = correctedExtrinsics(camera0_from_target_, correction);
    directionResidual(measurement_, seen(camera0_from_target), &by_point);
  }
  const Mat23 by_camera0 = by_point * camera0_from_target.rotation.toRotationMatrix().transpose();
  if (jacobians[0]) {
    Eigen::Map<RowMajor2<kLandmarkSize>>(jacobians[0]) << by_camera0 * base_.tangent_C,
        -by_camera0 * camera0_from_target.translation - by_point * measurement_.origin_C;
  }
  if (jacobians[1]) {
    Eigen::Map<RowMajor2<kExtrinsicsSize>> by_camera(jacobians[1]);
    by_camera = by_point * byFurtherExtrinsics(camera0_from_target, correction, point_C0, rho);
  }
  return true;
}

}  // namespace lodeline

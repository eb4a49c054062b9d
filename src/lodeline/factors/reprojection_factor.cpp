#include "lodeline/factors/reprojection_factor.h"

#include "lodeline/factors/parameters.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

template <int Cols>
using RowMajor2 = Eigen::Matrix<double, 2, Cols, Eigen::RowMajor>;

}  // namespace

LandmarkBase::LandmarkBase(const Vec3& bearing) : bearing_C(bearing), tangent_C(tangentBasis(bearing)) {}

/// Intermediate values from landmark to target camera at one pair of poses, as the Jacobians need them.
struct ReprojectionFactor::Chain {
  Mat3 camera_rotation_world;  // R_BC'^T R_t^T
  Mat3 world_rotation_host;    // R_h R_BC
  Vec3 baseline_W;             // from target camera to host camera
  Vec3 host_arm_W;             // R_h (R_BC d + rho p_BC)
  Vec3 target_arm_W;           // P - rho p_t
  Vec3 point_C;                // q

  Chain(const ReprojectionFactor& factor, const Rigid3& host, const Rigid3& target, const double* landmark) {
    const double rho = landmark[2];
    const Mat3 host_rotation = host.rotation.toRotationMatrix();
    const Mat3 target_rotation = target.rotation.toRotationMatrix();
    const Vec3 host_camera_arm_W = host_rotation * factor.body_from_host_camera_.translation;
    const Vec3 target_camera_arm_W = target_rotation * factor.body_from_target_camera_.translation;
    const Vec3 between_bodies_W = host.translation - target.translation;
    world_rotation_host = host_rotation * factor.body_from_host_camera_.rotation.toRotationMatrix();
    camera_rotation_world =
        (target_rotation * factor.body_from_target_camera_.rotation.toRotationMatrix()).transpose();
    baseline_W = between_bodies_W + host_camera_arm_W - target_camera_arm_W;
    const Vec3 direction_W = world_rotation_host * factor.base_.direction(landmark);
    host_arm_W = direction_W + rho * host_camera_arm_W;
    target_arm_W = host_arm_W + rho * between_bodies_W;
    point_C = camera_rotation_world * (direction_W + rho * baseline_W);
  }
};

ReprojectionFactor::ReprojectionFactor(const DirectionMeasurement& measurement, const LandmarkBase& base,
                                       const Rigid3& body_from_host_camera,
                                       const Rigid3& body_from_target_camera,
                                       const double* host_linearization_point,
                                       const double* target_linearization_point)
    : measurement_(measurement),
      base_(base),
      body_from_host_camera_(body_from_host_camera),
      body_from_target_camera_(body_from_target_camera),
      host_linearization_point_(host_linearization_point),
      target_linearization_point_(target_linearization_point) {}

bool ReprojectionFactor::Evaluate(double const* const* parameters, double* residuals,
                                  double** jacobians) const {
  const double* landmark = parameters[2];
  Chain chain(*this, poseFromBlock(parameters[0]), poseFromBlock(parameters[1]), landmark);
  Mat23 by_point;
  Eigen::Map<Vec2> residual(residuals);
  residual = directionResidual(measurement_, measurement_.fromOrigin(chain.point_C, landmark[2]),
                               jacobians ? &by_point : nullptr);
  if (!jacobians) return true;

  if (host_linearization_point_ || target_linearization_point_) {
    chain = Chain(*this, poseFromBlock(host_linearization_point_ ? host_linearization_point_ : parameters[0]),
                  poseFromBlock(target_linearization_point_ ? target_linearization_point_ : parameters[1]),
                  landmark);
    directionResidual(measurement_, measurement_.fromOrigin(chain.point_C, landmark[2]), &by_point);
  }
  const double rho = landmark[2];
  const Mat23 by_world = by_point * chain.camera_rotation_world;
  if (jacobians[0]) {
    Eigen::Map<RowMajor2<kPoseSize>> host(jacobians[0]);
    host << rho * by_world, -by_world * so3::skew(chain.host_arm_W), Vec2::Zero();
  }
  if (jacobians[1]) {
    Eigen::Map<RowMajor2<kPoseSize>> target(jacobians[1]);
    target << -rho * by_world, by_world * so3::skew(chain.target_arm_W), Vec2::Zero();
  }
  if (jacobians[2]) {
    Eigen::Map<RowMajor2<kLandmarkSize>> point(jacobians[2]);
    point << by_world * chain.world_rotation_host * base_.tangent_C,
        by_world * chain.baseline_W - by_point * measurement_.origin_C;
  }
  return true;
}

HostReprojectionFactor::HostReprojectionFactor(const DirectionMeasurement& measurement,
                                               const LandmarkBase& base,
                                               const Rigid3& target_camera_from_host_camera)
    : measurement_(measurement),
      base_(base),
      target_rotation_host_(target_camera_from_host_camera.rotation.toRotationMatrix()),
      target_translation_host_(target_camera_from_host_camera.translation) {}

bool HostReprojectionFactor::Evaluate(double const* const* parameters, double* residuals,
                                      double** jacobians) const {
  const double* landmark = parameters[0];
  const Vec3 point_C =
      target_rotation_host_ * base_.direction(landmark) + landmark[2] * target_translation_host_;
  const bool wanted = jacobians && jacobians[0];
  Mat23 by_point;
  Eigen::Map<Vec2> residual(residuals);
  residual = directionResidual(measurement_, measurement_.fromOrigin(point_C, landmark[2]),
                               wanted ? &by_point : nullptr);
  if (wanted) {
    Eigen::Map<RowMajor2<kLandmarkSize>> point(jacobians[0]);
    point << by_point * target_rotation_host_ * base_.tangent_C,
        by_point * (target_translation_host_ - measurement_.origin_C);
  }
  return true;
}

}  // namespace lodeline

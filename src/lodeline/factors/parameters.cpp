#include "lodeline/factors/parameters.h"

#include "lodeline/geometry/so3.h"

namespace lodeline {

Rigid3 poseFromBlock(const double* block) {
  return Rigid3(Quat(Eigen::Map<const Eigen::Vector4d>(block + 3)), Vec3(block));
}

void poseToBlock(const Rigid3& world_from_body, double* block) {
  Eigen::Map<Eigen::Matrix<double, kPoseSize, 1>> pose(block);
  pose << world_from_body.translation, world_from_body.rotation.coeffs();
}

Rigid3 perturbed(const Rigid3& world_from_body, const Eigen::Matrix<double, 6, 1>& perturbation) {
  return Rigid3((so3::exp(perturbation.tail<3>()) * world_from_body.rotation).normalized(),
                world_from_body.translation + perturbation.head<3>());
}

Eigen::Matrix<double, 6, 1> perturbationBetween(const Rigid3& from, const Rigid3& to) {
  Eigen::Matrix<double, 6, 1> perturbation;
  perturbation.head<3>() = to.translation - from.translation;
  perturbation.tail<3>() = so3::log(to.rotation * from.rotation.conjugate());
  return perturbation;
}

bool PoseManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  poseToBlock(perturbed(poseFromBlock(x), Eigen::Map<const Eigen::Matrix<double, 6, 1>>(delta)),
              x_plus_delta);
  return true;
}

bool PoseManifold::PlusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>(jacobian).setIdentity();
  return true;
}

bool PoseManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  Eigen::Map<Eigen::Matrix<double, 6, 1>> difference(y_minus_x);
  difference = perturbationBetween(poseFromBlock(x), poseFromBlock(y));
  return true;
}

bool PoseManifold::MinusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>(jacobian).setIdentity();
  return true;
}

}  // namespace lodeline

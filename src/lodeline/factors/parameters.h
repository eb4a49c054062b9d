#pragma once

#include <ceres/manifold.h>

#include "lodeline/types.h"

namespace lodeline {

// Memory layout of the parameter blocks that Ceres optimizes.
//
// Pose block, 7 doubles: p_W_B (m), then the quaternion of R_W_B as x y z w. Its perturbation has 6
// coordinates [dp, dtheta], both in world axes: p <- p + dp, q <- exp(dtheta) * q. World axes keep the
// unobservable directions (translation, rotation about gravity) constant, which makes heading variance a
// plain entry of the covariance.
//
// Motion block, 9 doubles: v_W (m/s), gyroscope bias b_g (rad/s), accelerometer bias b_a (m/s^2).
//
// Cost functions write the derivative with respect to the 6 perturbation coordinates into the first 6 of a
// pose block's 7 Jacobian columns and zero into the last; PoseManifold's plus-Jacobian picks those six out
// again.
//
// Linearization points (first-estimate Jacobians): a cost function may be given, per block, a pointer to the
// block's linearization point. The residual is taken at the current value but the Jacobian at the
// linearization point. Blocks in a marginalization prior are then linearized at one point for all factors
// (Huang, Mourikis & Roumeliotis, "Observability-based rules for designing consistent EKF SLAM estimators",
// IJRR 2010). A null pointer means: linearize at the current value.

constexpr int kPoseSize = 7;
constexpr int kPoseTangentSize = 6;
constexpr int kMotionSize = 9;

Rigid3 poseFromBlock(const double* block);
void poseToBlock(const Rigid3& world_from_body, double* block);

/// world_from_body after a perturbation [dp, dtheta] in world axes.
Rigid3 perturbed(const Rigid3& world_from_body, const Eigen::Matrix<double, 6, 1>& perturbation);

/// The perturbation [dp, dtheta] that takes `from` to `to`.
Eigen::Matrix<double, 6, 1> perturbationBetween(const Rigid3& from, const Rigid3& to);

class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return kPoseSize; }
  int TangentSize() const override { return kPoseTangentSize; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

}  // namespace lodeline

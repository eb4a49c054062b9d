#pragma once

#include <ceres/cost_function.h>

#include "lodeline/factors/parameters.h"
#include "lodeline/imu/preintegration.h"

namespace lodeline {

constexpr int kSensorAxesSize = 9;

/// Linearization points of the inertial factor. Null: the Jacobian of that block is taken at its current
/// value.
struct InertialLinearizationPoints {
  const double* pose_k = nullptr;
  const double* motion_k = nullptr;
  const double* pose_k1 = nullptr;
  const double* motion_k1 = nullptr;
  const double* gyroscope_axes = nullptr;
  const double* accelerometer_axes = nullptr;
};

/// The sensors whose axes are blocks of the inertial factor. The axes of the others stay as calibrated.
struct EstimatedAxes {
  bool gyroscope = false;
  bool accelerometer = false;
};

/// IMU factor between two states: 15 residuals on the blocks pose k, motion k, pose k+1 and motion k+1. Their
/// layout, the axes of the perturbation and the linearization points are those of factors/parameters.h. The
/// axes d of the gyroscope and of the accelerometer (SensorAxes) follow as further blocks where they are
/// estimated.
///
///   e = [ R_B_W^k (p^{k+1} - p^k - v^k dt - g dt^2 / 2) - alpha(b^k, d)]   m
///       [ R_B_W^k (v^{k+1} - v^k - g dt) - beta(b^k, d)                ]   m/s
///       [ log( R_B_W^k R_W_B^{k+1} gamma(b^k, d)^-1 )                  ]   rad
///       [ b_g^{k+1} - b_g^k                                            ]   rad/s
///       [ b_a^{k+1} - b_a^k                                            ]   m/s^2
///
/// The residual is in axes of body k and is whitened by the covariance of the preintegration. alpha, beta and
/// gamma are first-order expansions at the biases of k and the axes. This is section III-C of the paper with
/// gravity pointing down. Derivation: docs/theory/inertial.md.
class InertialFactor final : public ceres::CostFunction {
 public:
  /// `preintegration` must outlive the factor and may be repropagated between evaluations, not during one.
  InertialFactor(const Preintegration* preintegration, const Vec3& gravity_W,
                 const InertialLinearizationPoints& linearization_points = {}, EstimatedAxes axes = {});

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const Preintegration* preintegration_;
  Vec3 gravity_W_;
  InertialLinearizationPoints linearization_points_;
  EstimatedAxes axes_;
};

}  // namespace lodeline

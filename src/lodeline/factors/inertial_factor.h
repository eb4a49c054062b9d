#pragma once

#include <ceres/cost_function.h>

#include "lodeline/factors/parameters.h"
#include "lodeline/imu/preintegration.h"

namespace lodeline {

constexpr int kSensorAxesSize = 9;

/// Where the inertial factor takes its Jacobian. Null: linearize that block at its current value.
struct InertialLinearizationPoints {
  const double* pose_k = nullptr;
  const double* motion_k = nullptr;
  const double* pose_k1 = nullptr;
  const double* motion_k1 = nullptr;
  const double* gyroscope_axes = nullptr;
  const double* accelerometer_axes = nullptr;
};

/// Which sensors' axes are blocks of the inertial factor; the others' are as calibrated.
struct EstimatedAxes {
  bool gyroscope = false;
  bool accelerometer = false;
};

/// The IMU between two states, 15 residuals on the blocks pose k, motion k, pose k+1, motion k+1 (layout,
/// axes of the perturbation and linearization points as in factors/parameters.h), then the axes d of the
/// gyroscope and of the accelerometer (SensorAxes) where these are estimated.
///
///   e = [ R_B_W^k (p^{k+1} - p^k - v^k dt - g dt^2 / 2) - alpha(b^k, d)]   m
///       [ R_B_W^k (v^{k+1} - v^k - g dt) - beta(b^k, d)                ]   m/s
///       [ log( R_B_W^k R_W_B^{k+1} gamma(b^k, d)^-1 )                  ]   rad
///       [ b_g^{k+1} - b_g^k                                            ]   rad/s
///       [ b_a^{k+1} - b_a^k                                            ]   m/s^2
///
/// all in axes of body k, whitened by the preintegration's covariance; alpha, beta and gamma to first order
/// at the biases of k and the axes. The paper's section III-C with gravity pointing down. Derivation:
/// docs/inertial.md.
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

#pragma once

#include <ceres/manifold.h>

#include <vector>

#include "lodeline/factors/parameters.h"

namespace lodeline {

/// Sigmas of the prior that keeps a part of a graph determined while nothing connects it. They exceed every
/// distance in a cave system and every angle, so that the prior changes no result: 100 m count as chi^2 0.01.
constexpr double kWeakPosition_m = 1000.0;
constexpr double kWeakRotation_rad = 10.0;

/// The manifold of a pose of which only some of the six perturbations [dp, dtheta] are free.
class HeldPoseManifold final : public ceres::Manifold {
 public:
  /// `free_axes`: at least one of 0 to 5, ascending.
  explicit HeldPoseManifold(std::vector<int> free_axes) : free_axes_(std::move(free_axes)) {}
  int AmbientSize() const override { return kPoseSize; }
  int TangentSize() const override { return static_cast<int>(free_axes_.size()); }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;

 private:
  std::vector<int> free_axes_;
};

}  // namespace lodeline

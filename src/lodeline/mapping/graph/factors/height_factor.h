#pragma once

#include <ceres/sized_cost_function.h>

#include "lodeline/factors/parameters.h"

namespace lodeline {

/// Height h of the body by odometry, with an offset b that is common to a dive: r = (p_z + b - h) / sigma.
/// Parameters: pose of the body, offset (m).
class HeightFactor final : public ceres::SizedCostFunction<1, kPoseSize, 1> {
 public:
  HeightFactor(double height_m, double sigma_m);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  double height_m_, sigma_m_;
};

/// Depth d of the origin of a dive's odometry below the surface, whose height is s. The origin has the height
/// -b, where b is the offset of HeightFactor: r = (s + b - d) / sigma. Parameters: b, s (m).
class OriginDepthFactor final : public ceres::SizedCostFunction<1, 1, 1> {
 public:
  OriginDepthFactor(double depth_m, double sigma_m);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

  /// Replaces the measurement by a better one.
  void set(double depth_m, double sigma_m);
  double sigma_m() const { return sigma_m_; }

 private:
  double depth_m_ = 0.0, sigma_m_ = 1.0;
};

}  // namespace lodeline

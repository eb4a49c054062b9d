#pragma once

#include <ceres/sized_cost_function.h>

#include "lodeline/factors/parameters.h"

namespace lodeline {

/// Height h of the body by pressure, with an offset b that is common to a dive: r = (p_z + b - h) / sigma.
/// Parameters: pose of the body, offset (m).
class HeightFactor final : public ceres::SizedCostFunction<1, kPoseSize, 1> {
 public:
  HeightFactor(double height_m, double sigma_m);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  double height_m_, sigma_m_;
};

}  // namespace lodeline

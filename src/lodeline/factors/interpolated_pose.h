#pragma once

#include <ceres/cost_function.h>

#include <memory>

#include "lodeline/factors/parameters.h"

namespace lodeline {

/// Where a body was at a moment between two others, as a function of its poses then. With share s of the time
/// between them,
///   p = (1 - s) p_b + s p_a + R_b w,   R = exp(s log(R_a D_a^T R_b^T)) R_b D,
/// where w (the bow over the chord), D and D_a (this and the later attitude, seen from the earlier) are as
/// they were when the poses were known best. A rigid motion of both takes the moment along.
class PoseInterpolation {
 public:
  /// `share` lies between 0 and 1.
  PoseInterpolation(const Rigid3& before, const Rigid3& pose, const Rigid3& after, double share);

  Rigid3 pose(const Rigid3& before, const Rigid3& after) const;

  /// How it moves ([dp, dtheta], world axes) with the poses before and after.
  struct Derivatives {
    Mat6 by_before, by_after;
  };
  Derivatives derivatives(const Rigid3& before, const Rigid3& after) const;

 private:
  /// What the later attitude has turned by since, against the earlier; world axes.
  Vec3 closing_W(const Rigid3& before, const Rigid3& after) const;

  double share_;
  Vec3 bow_B_;
  Quat before_from_this_, before_from_after_;
};

/// A factor of a pose that two others stand in for. Blocks: those of the factor, with the pose before in
/// place of that pose, and last the pose after.
class InterpolatedPoseFactor final : public ceres::CostFunction {
 public:
  /// `pose_block` counts the factor's blocks. First estimates may be null (factors/parameters.h); those of
  /// the factor should be where the interpolation has the pose between them.
  InterpolatedPoseFactor(std::unique_ptr<ceres::CostFunction> factor, size_t pose_block,
                         const PoseInterpolation& interpolation, const double* first_before = nullptr,
                         const double* first_after = nullptr);

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  std::unique_ptr<ceres::CostFunction> factor_;
  size_t pose_block_;
  PoseInterpolation interpolation_;
  const double* first_before_;
  const double* first_after_;
};

}  // namespace lodeline

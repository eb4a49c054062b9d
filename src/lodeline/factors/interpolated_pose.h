#pragma once

#include <ceres/cost_function.h>

#include <memory>

#include "lodeline/factors/parameters.h"

namespace lodeline {

/// Pose (world_from_body) at a time between two other poses, as a function of these. s is the share of
/// the time between the poses before (b) and after (a) that has passed:
///   p = (1 - s) p_b + s p_a + R_b w,   R = exp(s log(R_a D_a^T R_b^T)) R_b D.
/// w is the offset from the straight line between p_b and p_a. D = R_b^T R and D_a = R_b^T R_a are the
/// attitudes of this pose and of the later one relative to the earlier one. w, D and D_a are constants,
/// computed from the poses given to the constructor. A rigid motion of both outer poses moves the
/// interpolated pose with them.
class PoseInterpolation {
 public:
  /// `share` lies between 0 and 1.
  PoseInterpolation(const Rigid3& before, const Rigid3& pose, const Rigid3& after, double share);

  Rigid3 pose(const Rigid3& before, const Rigid3& after) const;

  /// Derivatives of the interpolated pose's perturbation [dp, dtheta] (world axes) by those of both outer
  /// poses.
  struct Derivatives {
    Mat6 by_before, by_after;
  };
  Derivatives derivatives(const Rigid3& before, const Rigid3& after) const;

 private:
  /// Rotation vector of the change, since construction, of the later attitude relative to the earlier:
  /// log(R_a D_a^T R_b^T), world axes.
  Vec3 closing_W(const Rigid3& before, const Rigid3& after) const;

  double share_;
  Vec3 bow_B_;
  Quat before_from_this_, before_from_after_;
};

/// Replaces one pose block of another factor by a pose interpolated between two others. Blocks: those of the
/// factor, with the pose before in place of the replaced pose, and the pose after as the last block.
class InterpolatedPoseFactor final : public ceres::CostFunction {
 public:
  /// `pose_block`: index of the replaced block in `factor`. `first_before` and `first_after`: linearization
  /// points, may be null (factors/parameters.h). The linearization point of the replaced pose in `factor`
  /// should be the pose interpolated between these two.
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

#pragma once

#include <ceres/cost_function.h>

#include <memory>

#include "lodeline/factors/parameters.h"
#include "lodeline/inertial/preintegration.h"

namespace lodeline {

/// What forces were read with: the true one is (I + D) (reading - b).
struct AccelerometerCalibration {
  Vec3 bias_B = Vec3::Zero();            ///< b, m/s^2
  SensorAxes axes = SensorAxes::Zero();  ///< D
};

/// What an interpolation was worked out with: gravity, the time T between the poses, and the accelerometer's
/// calibration as far as it was known.
struct Interval {
  Vec3 gravity_W = Vec3::Zero();  ///< m/s^2
  double elapsed_s = 0.0;
  AccelerometerCalibration accelerometer;
};

/// Where a body was at a moment between two others, as a function of its poses then and of the
/// accelerometer's calibration. With share s of the time T between them,
///   p = (1 - s) p_b + s p_a + R_b (w + k (b - b_0) + (D - D_0) w) - k g,   k = s (1 - s) T^2 / 2,
///   R = exp(s log(R_a D_a^T R_b^T)) R_b D_t,
/// where w, D_t and D_a (this and the later attitude, seen from the earlier) are as they were when the poses
/// were known best. p less the chord is the bow that the accelerations between the poses make, twice
/// integrated between fixed ends: of forces that turn with the body (w is -k times their mean) and of
/// gravity, which does not. A shift of both poses and a turn about gravity take the moment along.
class PoseInterpolation {
 public:
  /// `share` lies between 0 and 1.
  PoseInterpolation(const Rigid3& before, const Rigid3& pose, const Rigid3& after, double share,
                    const Interval& interval);

  Rigid3 pose(const Rigid3& before, const Rigid3& after, const AccelerometerCalibration& accelerometer) const;

  /// How it moves ([dp, dtheta], world axes) with the poses before and after, and p with bias and axes.
  struct Derivatives {
    Mat6 by_before, by_after;
    Mat3 by_bias;
    Eigen::Matrix<double, 3, 9> by_axes;
  };
  Derivatives derivatives(const Rigid3& before, const Rigid3& after,
                          const AccelerometerCalibration& accelerometer) const;

 private:
  /// What the later attitude has turned by since, against the earlier; world axes.
  Vec3 closing_W(const Rigid3& before, const Rigid3& after) const;
  /// The part of the bow that turns with the body, in the world.
  Vec3 turningBow_W(const Rigid3& before, const AccelerometerCalibration& accelerometer) const;

  double share_;
  Interval interval_;
  double bow_per_acceleration_s2_;  ///< k
  Vec3 bow_B_;                      ///< w
  Quat before_from_this_, before_from_after_;
};

/// Of the blocks that stand in for a pose; each may be null (factors/parameters.h).
struct InterpolationFirstEstimates {
  const double *before = nullptr, *after = nullptr, *motion = nullptr, *axes = nullptr;
};

/// A factor of a pose that two others stand in for. Blocks: those of the factor, with the pose before in
/// place of that pose, then the pose after, a motion (factors/parameters.h) with the accelerometer's bias,
/// and last, where they are estimated, the accelerometer's axes.
class InterpolatedPoseFactor final : public ceres::CostFunction {
 public:
  /// `pose_block` counts the factor's blocks. First estimates of the factor should be where the interpolation
  /// has the pose between those given.
  InterpolatedPoseFactor(std::unique_ptr<ceres::CostFunction> factor, size_t pose_block,
                         const PoseInterpolation& interpolation, bool has_axes,
                         const InterpolationFirstEstimates& first = {});

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  std::unique_ptr<ceres::CostFunction> factor_;
  size_t pose_block_;
  PoseInterpolation interpolation_;
  bool has_axes_;
  InterpolationFirstEstimates first_;
};

}  // namespace lodeline

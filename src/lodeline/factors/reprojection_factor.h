#pragma once

#include <ceres/sized_cost_function.h>

#include "lodeline/factors/direction_measurement.h"
#include "lodeline/types.h"

namespace lodeline {

/// Tangent basis of a landmark's parameters in its host camera. The direction is d = base + tangent * (a, b),
/// not normalized. rho (1/m) is the inverse distance along `base`, so the point lies at d / rho. The
/// parameter block is (a, b, rho). Points behind the camera or infinitely far away (rho = 0) need no special
/// case.
struct LandmarkBase {
  Vec3 bearing_C = Vec3::UnitZ();
  Mat32 tangent_C = Mat32::Identity();

  explicit LandmarkBase(const Vec3& bearing_C);
  LandmarkBase() : LandmarkBase(Vec3::UnitZ()) {}
  Vec3 direction(const double* landmark) const {
    return bearing_C + tangent_C * Vec2(landmark[0], landmark[1]);
  }
};

constexpr int kLandmarkSize = 3;

/// Reprojection error of a landmark in a frame other than its host frame (paper section III-B, e_r).
///
/// Blocks: pose of the host frame (7), pose of the target frame (7), landmark (3). R_h, p_h, R_t, p_t
/// are the body poses, R_BC, p_BC the extrinsics of host and target camera. o is the origin of the
/// measured ray, zero for a camera without a port.
///   P = R_h (R_BC d + rho p_BC) + rho p_h                  (rho times the point in the world)
///   q = R_BC'^T (R_t^T (P - rho p_t) - rho p_BC')          (rho times the point in the target camera)
///   e = directionResidual(q - rho o)
/// A point that falls behind the target's image plane is a gross outlier: constant error, zero Jacobian.
class ReprojectionFactor final : public ceres::SizedCostFunction<2, 7, 7, kLandmarkSize> {
 public:
  /// The linearization points may be null (see parameters.h). They must outlive the factor; the other
  /// arguments need not.
  ReprojectionFactor(const DirectionMeasurement& measurement, const LandmarkBase& base,
                     const Rigid3& body_from_host_camera, const Rigid3& body_from_target_camera,
                     const double* host_linearization_point, const double* target_linearization_point);

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  struct Chain;
  DirectionMeasurement measurement_;
  LandmarkBase base_;
  Rigid3 body_from_host_camera_;
  Rigid3 body_from_target_camera_;
  const double* host_linearization_point_;
  const double* target_linearization_point_;
};

/// Reprojection error in an image of the host frame itself, taken by the host camera or by a secondary
/// camera. It depends on the landmark alone: with the extrinsics R, p of the host camera in the target
/// camera, e = directionResidual(R d + rho (p - o)).
class HostReprojectionFactor final : public ceres::SizedCostFunction<2, kLandmarkSize> {
 public:
  HostReprojectionFactor(const DirectionMeasurement& measurement, const LandmarkBase& base,
                         const Rigid3& target_camera_from_host_camera);

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  DirectionMeasurement measurement_;
  LandmarkBase base_;
  Mat3 target_rotation_host_;
  Vec3 target_translation_host_;
};

}  // namespace lodeline

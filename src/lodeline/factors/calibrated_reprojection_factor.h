#pragma once

#include <ceres/cost_function.h>

#include <optional>

#include "lodeline/factors/reprojection_factor.h"
#include "lodeline/types.h"

namespace lodeline {

// Parameter blocks of the camera calibration that the window estimates. All are zero where the calibration
// files are right:
//   extrinsics of camera 0             [phi, xi] (rad, m), body axes
//   extrinsics of a secondary camera   [phi, xi] (rad, m), axes of camera 0
//   time offset                        dt (s), image time stamp + dt = time of the IMU clock
// The extrinsics of each secondary camera are relative to camera 0: a stereo calibration knows the poses of
// the cameras relative to each other far better than relative to the IMU.

constexpr int kExtrinsicsSize = 6;  ///< [phi, xi]
constexpr int kTimeOffsetSize = 1;

/// Pose of a sensor after the correction [phi, xi] of a calibration block: rotation exp(phi) * R, translation
/// p + xi.
Rigid3 correctedExtrinsics(const Rigid3& nominal, const double* correction);

/// Velocity of the body at the time of an image; extrapolates the pose of the body by a time offset. The
/// velocity counts as known: over the few milliseconds that matter, the effect of its error is negligible.
struct ImageMotion {
  Vec3 velocity_W = Vec3::Zero();          ///< m/s
  Vec3 angular_velocity_B = Vec3::Zero();  ///< rad/s, bias removed
  Vec3 velocity_B = Vec3::Zero();  ///< the same velocity in axes of the body (factors/rolling_shutter.h)

  Rigid3 poseAfter(const Rigid3& world_from_body, double dt_s) const;
};

/// Extrinsics of the host's camera 0 and of the target camera as the calibration files state them.
struct CameraPlacement {
  Rigid3 body_from_camera0;
  std::optional<Rigid3> camera0_from_target;  ///< empty where the target camera is camera 0
};

/// Linearization points of the blocks. Null: the Jacobian is taken at the current value
/// (factors/parameters.h).
struct CalibratedLinearizationPoints {
  const double* host = nullptr;
  const double* target = nullptr;
  const double* camera0 = nullptr;
  const double* time_offset = nullptr;
  const double* target_camera = nullptr;
};

/// ReprojectionFactor with the camera calibration as variables.
///
/// Blocks: pose of the host frame (7), pose of the target frame (7), landmark (3), extrinsics of camera
/// 0 (6), time offset (1). A secondary camera as target adds its extrinsics (6). The poses R_h, p_h and
/// R_t, p_t (world_from_body) are those at the true times of the images (R exp(w dt), p + v dt). Camera
/// 0 has the pose R_0, p_0 in the body, the target camera the pose R_r, p_r in camera 0. Then
///   m   = R_t^T (R_h (R_0 d + rho p_0) + rho (p_h - p_t)) - rho p_0
///   q_0 = R_0^T m,   q = R_r^T (q_0 - rho p_r)
///   e   = directionResidual(q - rho o)        with the origin o of the measured ray
class CalibratedReprojectionFactor final : public ceres::CostFunction {
 public:
  CalibratedReprojectionFactor(const DirectionMeasurement& measurement, const LandmarkBase& base,
                               const CameraPlacement& placement, const ImageMotion& host_motion,
                               const ImageMotion& target_motion,
                               const CalibratedLinearizationPoints& linearization_points = {});

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  struct Chain;
  DirectionMeasurement measurement_;
  LandmarkBase base_;
  CameraPlacement placement_;
  ImageMotion host_motion_, target_motion_;
  CalibratedLinearizationPoints linearization_points_;
};

/// Reprojection error in an image that a secondary camera took in the host frame itself, with the extrinsics
/// of that camera as a variable. Blocks: landmark (3), extrinsics of that camera (6).
class CalibratedStereoFactor final : public ceres::SizedCostFunction<2, kLandmarkSize, kExtrinsicsSize> {
 public:
  /// `linearization_point`: of the extrinsics, may be null.
  CalibratedStereoFactor(const DirectionMeasurement& measurement, const LandmarkBase& base,
                         const Rigid3& camera0_from_target, const double* linearization_point = nullptr);

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  DirectionMeasurement measurement_;
  LandmarkBase base_;
  Rigid3 camera0_from_target_;
  const double* linearization_point_;
};

}  // namespace lodeline

#pragma once

#include <ceres/cost_function.h>

#include <functional>
#include <memory>
#include <vector>

#include "lodeline/factors/calibrated_reprojection_factor.h"

namespace lodeline {

// Parameter block of the rolling shutters of all cameras:
//   shutter   [l_0, l_1, ...] (s): time from one row of camera i to the next; 0 where the shutter is global
// The stamp of an image is that of its middle row. A row `rows` below it is exposed rows * l later. The
// camera then has turned by rows l w and moved by rows l v. The ray that it measured is rotated and moved
// back into the camera at the image's time:
//   z' = exp(rows l w) z,   o' = exp(rows l w) o + rows l v
// All factors then hold without change, because they may have any ray with any origin (as behind a port).

constexpr int kShutterSize = 6;  ///< so many cameras at most

/// Motion of a camera in its own axes at the time of an image. It counts as known, like ImageMotion.
struct CameraMotion {
  Vec3 angular_velocity_C = Vec3::Zero();  ///< rad/s
  Vec3 velocity_C = Vec3::Zero();          ///< m/s

  double centre_row = 0.0;  ///< of the principal point, below the middle row of the image

  CameraMotion() = default;
  CameraMotion(const ImageMotion& body, const Rigid3& body_from_camera, double centre_row = 0.0);
};

/// Row of the principal point below the middle row of the image, by the calibration file.
double centreRow(const CameraCalibration& camera);

/// Rows from the middle row of the image down to the measured pixel.
double rowsBelowMiddle(const DirectionMeasurement& measurement, const CameraMotion& motion);

/// A measurement as the camera would have made it had it exposed the row at the time of the image.
DirectionMeasurement atTimeOfImage(const DirectionMeasurement& measurement, const CameraMotion& motion,
                                   double line_delay_s);

/// Change of the homogeneous point q of inverse scale rho (axes of the camera), as the measured ray sees it,
/// per second of line delay. Times d(residual)/dq of atTimeOfImage(), it is d(residual) / d(line delay).
Vec3 pointByLineDelay(const DirectionMeasurement& measurement, const CameraMotion& motion,
                      double line_delay_s, const Vec3& point_C, double rho);

/// A reprojection factor whose measurement depends on the shutter block, which is its last block.
class RollingShutterFactor final : public ceres::CostFunction {
 public:
  /// Makes the factor of a measurement. Its blocks come before the shutter block.
  using FactorOf = std::function<std::unique_ptr<ceres::CostFunction>(const DirectionMeasurement&)>;

  /// `linearization_points`: of the blocks of `factor_of`, null where the Jacobian is taken at the current
  /// value. That by the line delay is always taken at its current value, like that by the intrinsics.
  RollingShutterFactor(FactorOf factor_of, const DirectionMeasurement& measurement,
                       const CameraMotion& motion, int camera,
                       std::vector<const double*> linearization_points);

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  FactorOf factor_of_;
  DirectionMeasurement measurement_;
  CameraMotion motion_;
  int camera_;
  std::vector<const double*> linearization_points_;
};

}  // namespace lodeline

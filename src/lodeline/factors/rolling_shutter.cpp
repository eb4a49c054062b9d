#include "lodeline/factors/rolling_shutter.h"

#include <utility>

#include "lodeline/geometry/so3.h"

namespace lodeline {

CameraMotion::CameraMotion(const ImageMotion& body, const Rigid3& body_from_camera, double centre_row)
    : centre_row(centre_row) {
  const Quat camera_from_body = body_from_camera.rotation.conjugate();
  angular_velocity_C = camera_from_body * body.angular_velocity_B;
  velocity_C =
      camera_from_body * (body.velocity_B + body.angular_velocity_B.cross(body_from_camera.translation));
}

double centreRow(const CameraCalibration& camera) {
  const auto centre = makeCamera(camera)->project(Vec3::UnitZ());
  return centre ? centre->y() - 0.5 * (camera.height_px - 1) : 0.0;
}

double rowsBelowMiddle(const DirectionMeasurement& measurement, const CameraMotion& motion) {
  return motion.centre_row + measurement.from_centre_sigmas.y() / measurement.sigmas_per_px;
}

DirectionMeasurement atTimeOfImage(const DirectionMeasurement& measurement, const CameraMotion& motion,
                                   double line_delay_s) {
  const double later_s = rowsBelowMiddle(measurement, motion) * line_delay_s;
  const Mat3 turn = so3::exp(later_s * motion.angular_velocity_C).toRotationMatrix();
  DirectionMeasurement moved = measurement;
  moved.bearing_C = turn * measurement.bearing_C;
  moved.tangent_C = turn * measurement.tangent_C;
  moved.origin_C = turn * measurement.origin_C + later_s * motion.velocity_C;
  return moved;
}

Vec3 pointByLineDelay(const DirectionMeasurement& measurement, const CameraMotion& motion,
                      double line_delay_s, const Vec3& point_C, double rho) {
  const double rows = rowsBelowMiddle(measurement, motion);
  const Vec3 from_moved_C = point_C - rho * rows * line_delay_s * motion.velocity_C;
  return -rows * (motion.angular_velocity_C.cross(from_moved_C) + rho * motion.velocity_C);
}

RollingShutterFactor::RollingShutterFactor(FactorOf factor_of, const DirectionMeasurement& measurement,
                                           const CameraMotion& motion, int camera,
                                           std::vector<const double*> linearization_points)
    : factor_of_(std::move(factor_of)),
      measurement_(measurement),
      motion_(motion),
      camera_(camera),
      linearization_points_(std::move(linearization_points)) {
  set_num_residuals(2);
  *mutable_parameter_block_sizes() = factor_of_(measurement_)->parameter_block_sizes();
  mutable_parameter_block_sizes()->push_back(kShutterSize);
}

bool RollingShutterFactor::Evaluate(double const* const* parameters, double* residuals,
                                    double** jacobians) const {
  const size_t last = parameter_block_sizes().size() - 1;
  const auto factorAt = [&](double line_delay_s) {
    return factor_of_(atTimeOfImage(measurement_, motion_, line_delay_s));
  };
  const double line_delay_s = parameters[last][camera_];
  if (!factorAt(line_delay_s)->Evaluate(parameters, residuals, jacobians)) return false;
  if (!jacobians || !jacobians[last]) return true;

  // The residual is smooth in the line delay, and nearly linear: 1e-7 s move a pixel by thousandths of its
  // distance from the centre.
  constexpr double kStep_s = 1e-7;
  std::vector<const double*> at;
  for (size_t block = 0; block < last; ++block)
    at.push_back(linearization_points_[block] ? linearization_points_[block] : parameters[block]);
  Vec2 after, before;
  if (!factorAt(line_delay_s + kStep_s)->Evaluate(at.data(), after.data(), nullptr) ||
      !factorAt(line_delay_s - kStep_s)->Evaluate(at.data(), before.data(), nullptr))
    return false;
  Eigen::Map<Eigen::Matrix<double, 2, kShutterSize, Eigen::RowMajor>> by_shutter(jacobians[last]);
  by_shutter.setZero();
  by_shutter.col(camera_) = (after - before) / (2.0 * kStep_s);
  return true;
}

}  // namespace lodeline

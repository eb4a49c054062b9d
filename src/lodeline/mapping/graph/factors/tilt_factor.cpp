#include "lodeline/mapping/graph/factors/tilt_factor.h"

#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/graph/factors/whitening.h"

namespace lodeline {

TiltFactor::TiltFactor(const Vec3& up_B, double sigma_rad) : up_B_(up_B), sigma_rad_(sigma_rad) {
  if (!(std::abs(up_B.norm() - 1.0) < 1e-6)) throw InputError("tilt: the direction of up must have length 1");
  if (!(sigma_rad > 0.0) || !std::isfinite(sigma_rad)) throw InputError("tilt: sigma must be positive");
}

bool TiltFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Vec3 up_W = poseFromBlock(parameters[0]).rotation * up_B_;
  const Vec2 level = up_W.head<2>();
  const double sine = level.norm(), cosine = up_W.z();
  const double angle = std::atan2(sine, cosine);
  // Below this the series of alpha / sin alpha ends at one: its next term is alpha^2 / 6.
  const bool is_small = sine < 1e-8;
  const double stretch = is_small ? 1.0 : angle / sine;
  Eigen::Map<Vec2> residual(residuals);
  residual = stretch * level / sigma_rad_;
  if (!jacobians || !jacobians[0]) return true;

  const Mat3 turned = -so3::skew(up_W);  // d up_W / d theta
  Mat23 derivative = stretch * turned.topRows<2>();
  if (!is_small) {
    const Eigen::RowVector3d by_sine = level.transpose() / sine * turned.topRows<2>();
    const Eigen::RowVector3d by_angle = cosine * by_sine - sine * turned.row(2);
    derivative += level * (by_angle * sine - angle * by_sine) / (sine * sine);
  }
  Eigen::Matrix<double, 2, 6> columns = Eigen::Matrix<double, 2, 6>::Zero();
  columns.rightCols<3>() = derivative / sigma_rad_;
  writePoseJacobian<2>(columns, jacobians[0]);
  return true;
}

}  // namespace lodeline

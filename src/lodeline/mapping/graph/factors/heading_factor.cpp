#include "lodeline/mapping/graph/factors/heading_factor.h"

#include <cmath>
#include <numbers>

#include "lodeline/diagnostics.h"
#include "lodeline/mapping/graph/factors/whitening.h"
#include "lodeline/mapping/graph/motion/level_motion.h"

namespace lodeline {

HeadingFactor::HeadingFactor(const Quat& odom_from_body, double sigma_rad)
    : body_from_odom_(odom_from_body.conjugate()), sigma_rad_(sigma_rad) {
  checkPose(Rigid3(odom_from_body, Vec3::Zero()), "heading");
  if (!(sigma_rad > 0.0) || !std::isfinite(sigma_rad)) throw InputError("heading: sigma must be positive");
}

bool HeadingFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Quat q = poseFromBlock(parameters[0]).rotation * body_from_odom_;
  const double difference = azimuthOf(q) - *parameters[1];
  *residuals = std::remainder(difference, 2.0 * std::numbers::pi) / sigma_rad_;
  if (!jacobians) return true;

  if (jacobians[0]) {
    // q <- exp(theta) q changes w and z by dw = -theta . v / 2 and dz = (w theta_z + (theta x v)_z) / 2.
    const double vertical = q.w() * q.w() + q.z() * q.z();
    Eigen::Matrix<double, 1, 6> derivative = Eigen::Matrix<double, 1, 6>::Zero();
    if (vertical > 0.0) {
      derivative[3] = (q.w() * q.y() + q.z() * q.x()) / vertical;
      derivative[4] = (q.z() * q.y() - q.w() * q.x()) / vertical;
    }
    derivative[5] = 1.0;
    writePoseJacobian<1>(derivative / sigma_rad_, jacobians[0]);
  }
  if (jacobians[1]) *jacobians[1] = -1.0 / sigma_rad_;
  return true;
}

}  // namespace lodeline

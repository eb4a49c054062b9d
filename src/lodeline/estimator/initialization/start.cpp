#include "lodeline/estimator/initialization/start.h"

#include <algorithm>

#include "lodeline/geometry/so3.h"

namespace lodeline {

Prior startPrior(Frame& first, const InitialStateOptions& options, double tilt_sigma_rad) {
  const double tilt_sigma = std::max(tilt_sigma_rad, options.tilt_sigma_min_rad);
  Eigen::Matrix<double, 15, 1> sigmas;
  sigmas << Vec3::Constant(options.position_sigma_m), tilt_sigma, tilt_sigma, options.yaw_sigma_rad,
      Vec3::Constant(options.velocity_sigma_m_per_s), Vec3::Constant(options.gyroscope_bias_sigma_rad_per_s),
      Vec3::Constant(options.accelerometer_bias_sigma_m_per_s2);
  Prior prior;
  prior.append(first.pose.data(), kPoseSize, sigmas.head<kPoseTangentSize>());
  prior.append(first.motion.data(), kMotionSize, sigmas.tail<kMotionSize>());
  return prior;
}

void tieTiltToAccelerometerBias(const Frame& first, double gravity_m_per_s2, Prior* prior) {
  constexpr int kTilt = 3, kAccelerometerBias = kPoseTangentSize + 6;
  // True attitude = exp(tilt) estimate, estimate * (force - bias) = exp(-tilt) g e_z: tilt = e_z x R b / g.
  const Mat3 world_from_body = first.worldFromBody().rotation.toRotationMatrix();
  const Mat3 tilt_by_bias = so3::skew(Vec3::UnitZ()) * world_from_body / gravity_m_per_s2;
  const Eigen::Matrix2d weight = prior->sqrt_information.block<2, 2>(kTilt, kTilt);
  prior->sqrt_information.block<2, 3>(kTilt, kAccelerometerBias) = -weight * tilt_by_bias.topRows<2>();
}

}  // namespace lodeline

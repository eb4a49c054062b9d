#include "lodeline/estimator/start.h"

#include <algorithm>

namespace lodeline {

Prior startPrior(Frame& first, const InitialStateOptions& options, double tilt_sigma_rad, bool still) {
  const double tilt_sigma = std::max(tilt_sigma_rad, options.tilt_sigma_min_rad);
  const double velocity_sigma = still ? options.velocity_sigma_still_m_per_s : options.velocity_sigma_m_per_s;
  Eigen::Matrix<double, 15, 1> sigmas;
  sigmas << Vec3::Constant(options.position_sigma_m), tilt_sigma, tilt_sigma, options.yaw_sigma_rad,
      Vec3::Constant(velocity_sigma), Vec3::Constant(options.gyroscope_bias_sigma_rad_per_s),
      Vec3::Constant(options.accelerometer_bias_sigma_m_per_s2);
  Prior prior;
  prior.append(first.pose.data(), kPoseSize, sigmas.head<kPoseTangentSize>());
  prior.append(first.motion.data(), kMotionSize, sigmas.tail<kMotionSize>());
  return prior;
}

}  // namespace lodeline

#include "lodeline/estimator/dvl/ping_motion.h"

#include <cmath>

#include "lodeline/geometry/so3.h"

namespace lodeline {

PingMotion::PingMotion(const Preintegration& interval, const Vec3& rate_at_ping_B)
    : elapsed_s(interval.dt_s()),
      rotation(interval.motion().gamma),
      velocity_change(interval.motion().beta),
      rate_B(rate_at_ping_B),
      gyroscope_bias_B(interval.gyroscopeBias()),
      accelerometer_bias_B(interval.accelerometerBias()) {
  using namespace inertial_error;
  const Preintegration::Mat96& by_bias = interval.biasJacobian();
  rotation_by_gyroscope_bias = by_bias.block<3, 3>(kTheta, 0);
  velocity_by_gyroscope_bias = by_bias.block<3, 3>(kBeta, 0);
  velocity_by_accelerometer_bias = by_bias.block<3, 3>(kBeta, 3);
  sigma_m_per_s = std::sqrt(interval.covariance().block<3, 3>(kBeta, kBeta).trace() / 3.0);
}

Quat PingMotion::rotationFor(const Vec3& gyroscope_bias) const {
  return so3::exp(rotation_by_gyroscope_bias * (gyroscope_bias - gyroscope_bias_B)) * rotation;
}

}  // namespace lodeline

#include "lodeline/imu/step_noise.h"

#include "lodeline/geometry/squared.h"

namespace lodeline {
namespace {

constexpr double kStandardGravity_m_per_s2 = 9.80665;

}  // namespace

StepNoise stepNoise(const ImuSample& from, const ImuSample& to, const Vec3& gyroscope_bias_B,
                    const ImuNoise& at_rest, double inflation, const MotionNoiseOptions& options) {
  const double h = (to.time - from.time).seconds();
  const double unresolved = h * squared(options.unresolved_share);
  const double axes = options.axis_error_time_s * squared(options.axis_error) *
                      (to.angular_velocity_B - gyroscope_bias_B).squaredNorm();
  StepNoise noise;
  noise.gyroscope = squared(inflation * at_rest.gyroscope_density_rad_per_s_sqrtHz) +
                    unresolved * (to.angular_velocity_B - from.angular_velocity_B).squaredNorm() + axes;
  noise.accelerometer = squared(inflation * at_rest.accelerometer_density_m_per_s2_sqrtHz) +
                        unresolved * (to.specific_force_B - from.specific_force_B).squaredNorm();
  noise.gyroscope_walk = squared(inflation * at_rest.gyroscope_random_walk_rad_per_s2_sqrtHz);
  noise.accelerometer_walk = squared(inflation * at_rest.accelerometer_random_walk_m_per_s3_sqrtHz) +
                             squared(kStandardGravity_m_per_s2) * axes;
  return noise;
}

}  // namespace lodeline

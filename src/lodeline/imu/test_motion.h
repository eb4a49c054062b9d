#pragma once

#include <cmath>
#include <vector>

#include "lodeline/geometry/so3.h"
#include "lodeline/imu/gravity.h"
#include "lodeline/imu/propagation.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Smooth test motion with all derivatives in closed form, about 1.5 m/s, 4 m/s^2 and 2 rad/s. R_W_B = exp(a
/// f(t)) exp(b h(t)), so that the body rate is b h' + exp(b h)^T a f'.
struct TestMotion {
  Vec3 a = Vec3(0.9, -0.5, 0.7);
  Vec3 b = Vec3(-0.6, 0.8, 0.5);

  Quat rotation(double t) const { return so3::exp(a * std::sin(1.3 * t)) * so3::exp(b * std::cos(1.9 * t)); }
  Vec3 position(double t) const {
    return Vec3(0.8 * std::sin(1.7 * t), 0.6 * std::cos(2.1 * t), 0.4 * std::sin(2.9 * t + 0.3));
  }
  Vec3 velocity(double t) const {
    return Vec3(0.8 * 1.7 * std::cos(1.7 * t), -0.6 * 2.1 * std::sin(2.1 * t),
                0.4 * 2.9 * std::cos(2.9 * t + 0.3));
  }
  Vec3 acceleration(double t) const {
    return Vec3(-0.8 * 1.7 * 1.7 * std::sin(1.7 * t), -0.6 * 2.1 * 2.1 * std::cos(2.1 * t),
                -0.4 * 2.9 * 2.9 * std::sin(2.9 * t + 0.3));
  }
  Vec3 rate_B(double t) const {
    return b * (-1.9 * std::sin(1.9 * t)) +
           so3::exp(b * std::cos(1.9 * t)).conjugate() * (a * (1.3 * std::cos(1.3 * t)));
  }

  ImuSample reading(Time time, const Vec3& gyroscope_bias = Vec3::Zero(),
                    const Vec3& accelerometer_bias = Vec3::Zero()) const {
    const double t = time.seconds();
    ImuSample sample;
    sample.time = time;
    sample.angular_velocity_B = rate_B(t) + gyroscope_bias;
    sample.specific_force_B =
        rotation(t).conjugate() * (acceleration(t) - standardGravity_W()) + accelerometer_bias;
    return sample;
  }

  std::vector<ImuSample> readings(double from_s, double to_s, double rate_hz,
                                  const Vec3& gyroscope_bias = Vec3::Zero(),
                                  const Vec3& accelerometer_bias = Vec3::Zero()) const {
    const int steps = static_cast<int>(std::lround((to_s - from_s) * rate_hz));
    std::vector<ImuSample> samples;
    for (int i = 0; i <= steps; ++i) {
      samples.push_back(reading(Time::fromSeconds(from_s + i / rate_hz), gyroscope_bias, accelerometer_bias));
    }
    return samples;
  }

  NavigationState state(Time time, const Vec3& gyroscope_bias = Vec3::Zero(),
                        const Vec3& accelerometer_bias = Vec3::Zero()) const {
    const double t = time.seconds();
    return {time, Rigid3(rotation(t), position(t)), velocity(t), gyroscope_bias, accelerometer_bias};
  }
};

/// [alpha, beta, theta] of the error between two true states and an integration (see Preintegration).
inline Eigen::Matrix<double, 9, 1> motionError(const NavigationState& from, const NavigationState& to,
                                               const Preintegration& preintegration, const Vec3& gravity_W) {
  const double dt = (to.time - from.time).seconds();
  const Quat body_from_world = from.world_from_body.rotation.conjugate();
  const Rigid3& pose_0 = from.world_from_body;
  const Rigid3& pose_1 = to.world_from_body;
  const RelativeMotion& motion = preintegration.motion();
  Eigen::Matrix<double, 9, 1> error;
  error << body_from_world * (pose_1.translation - pose_0.translation - dt * from.velocity_W -
                              0.5 * dt * dt * gravity_W) -
               motion.alpha,
      body_from_world * (to.velocity_W - from.velocity_W - dt * gravity_W) - motion.beta,
      so3::log(body_from_world * pose_1.rotation * motion.gamma.conjugate());
  return error;
}

}  // namespace lodeline

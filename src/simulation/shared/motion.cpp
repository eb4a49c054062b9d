#include "simulation/shared/motion.h"

#include <cmath>
#include <utility>

namespace lodeline {
namespace {

/// A vector with its first two derivatives with respect to time.
struct VectorJet {
  Vec3 value, rate, acceleration;
};

VectorJet vectorJet(const Jet& x, const Jet& y, const Jet& z) {
  return {Vec3(x.value, y.value, z.value), Vec3(x.rate, y.rate, z.rate),
          Vec3(x.acceleration, y.acceleration, z.acceleration)};
}

/// An attitude with its angular velocity and acceleration, all in the reference frame.
struct AttitudeJet {
  Quat rotation;
  Vec3 angular_velocity, angular_acceleration;

  /// Transforms a vector from the rotating frame to the reference frame.
  VectorJet operator*(const VectorJet& v) const {
    const Vec3 value = rotation * v.value;
    const Vec3 rate = rotation * v.rate;
    return {value, rate + angular_velocity.cross(value),
            rotation * v.acceleration + 2.0 * angular_velocity.cross(rate) +
                angular_acceleration.cross(value) + angular_velocity.cross(angular_velocity.cross(value))};
  }

  /// Adds a rotation about a unit axis of the rotating frame.
  AttitudeJet turned(const Vec3& axis, const Jet& angle) const {
    const Vec3 axis_outside = rotation * axis;
    return {(rotation * Quat(Eigen::AngleAxisd(angle.value, axis))).normalized(),
            angular_velocity + angle.rate * axis_outside,
            angular_acceleration + angle.acceleration * axis_outside +
                angle.rate * angular_velocity.cross(axis_outside)};
  }
};

}  // namespace

Jet MotionChannel::at(double time_s) const {
  Jet sum;
  for (const Spline& spline : splines) sum += spline.at(time_s);
  for (const Enveloped& e : enveloped) sum += product(e.envelope.at(time_s), e.wave.at(time_s));
  for (const Sine& sine : sines) {
    Jet phase = sine.phase.at(time_s);
    phase = {sine.phase_multiple * phase.value + sine.phase_offset_rad, sine.phase_multiple * phase.rate,
             sine.phase_multiple * phase.acceleration};
    sum += modulatedSine(sine.amplitude.at(time_s), phase);
  }
  return sum;
}

Motion::Motion(MotionChannels channels, const Rigid3& diver_from_body, double duration_s)
    : channels_(std::move(channels)), diver_from_body_(diver_from_body), duration_s_(duration_s) {
  shift_W_ = -at(0.0).world_from_body.translation;
}

MotionState Motion::at(double time_s) const {
  const MotionChannels& c = channels_;
  const VectorJet path = vectorJet(c.east.at(time_s), c.north.at(time_s), c.up.at(time_s));
  const VectorJet sway = vectorJet(c.forward.at(time_s), c.left.at(time_s), c.above.at(time_s));
  const AttitudeJet level{Quat::Identity(), Vec3::Zero(), Vec3::Zero()};
  const AttitudeJet heading = level.turned(Vec3::UnitZ(), c.yaw.at(time_s));
  const AttitudeJet attitude =
      heading.turned(Vec3::UnitY(), c.pitch.at(time_s)).turned(Vec3::UnitX(), c.roll.at(time_s));

  const VectorJet swayed = heading * sway;
  const VectorJet lever = attitude * VectorJet{diver_from_body_.translation, Vec3::Zero(), Vec3::Zero()};
  MotionState state;
  const Quat world_from_body = (attitude.rotation * diver_from_body_.rotation).normalized();
  state.world_from_body = Rigid3(world_from_body, path.value + swayed.value + lever.value + shift_W_);
  state.velocity_W = path.rate + swayed.rate + lever.rate;
  state.acceleration_W = path.acceleration + swayed.acceleration + lever.acceleration;
  state.angular_velocity_B = world_from_body.conjugate() * attitude.angular_velocity;
  state.angular_acceleration_B = world_from_body.conjugate() * attitude.angular_acceleration;
  return state;
}

ImuSample perfectImuSample(const MotionState& state, Time time, const Vec3& gravity_W) {
  return {time, state.angular_velocity_B,
          state.world_from_body.rotation.conjugate() * (state.acceleration_W - gravity_W)};
}

double pathLength(const Motion& motion, double begin_s, double end_s) {
  const int steps = std::max(1, static_cast<int>(std::ceil((end_s - begin_s) * 20.0)));
  const double step_s = (end_s - begin_s) / steps;
  double length_m = 0.0;
  for (int i = 0; i < steps; ++i)
    length_m += motion.at(begin_s + (i + 0.5) * step_s).velocity_W.norm() * step_s;
  return length_m;
}

}  // namespace lodeline

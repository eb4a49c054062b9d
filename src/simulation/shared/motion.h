#pragma once

#include <vector>

#include "lodeline/rig.h"
#include "lodeline/types.h"
#include "simulation/shared/spline.h"

namespace lodeline {

/// True state of the rig at one instant.
struct MotionState {
  Rigid3 world_from_body;
  Vec3 velocity_W = Vec3::Zero();              ///< of the body origin, m/s
  Vec3 acceleration_W = Vec3::Zero();          ///< of the body origin, m/s^2, without gravity
  Vec3 angular_velocity_B = Vec3::Zero();      ///< rad/s
  Vec3 angular_acceleration_B = Vec3::Zero();  ///< rad/s^2
};

/// One coordinate of the motion as a function of time: a sum of splines, splines under an envelope, and
/// amplitude- and phase-modulated sines.
struct MotionChannel {
  struct Enveloped {
    Spline envelope;
    Spline wave;
  };
  struct Sine {
    Spline amplitude;
    Spline phase;
    double phase_multiple = 1.0;
    double phase_offset_rad = 0.0;
  };
  std::vector<Spline> splines;
  std::vector<Enveloped> enveloped;
  std::vector<Sine> sines;

  Jet at(double time_s) const;
};

/// The coordinates that compose a motion. The diver frame D is x forward, y left, z up.
struct MotionChannels {
  MotionChannel east, north, up;       ///< slow path of the origin of D in W, m
  MotionChannel forward, left, above;  ///< swaying relative to that path along the axes of the yawed frame, m
  MotionChannel yaw;                   ///< counter-clockwise from east, rad
  MotionChannel pitch;                 ///< nose down positive, rad
  MotionChannel roll;                  ///< right side down positive, rad
};

/// A trajectory that is four times continuously differentiable, with velocity, acceleration and angular rates
/// from analytic derivatives. R_W_D = Rz(yaw) Ry(pitch) Rx(roll); the body is rigidly fixed in D.
class Motion {
 public:
  /// Defined on [-kMargin_s, duration_s + kMargin_s], so that delayed and early readings exist at the ends.
  /// The world is shifted so that the body starts at its origin.
  Motion(MotionChannels channels, const Rigid3& diver_from_body, double duration_s);

  static constexpr double kMargin_s = 2.0;

  MotionState at(double time_s) const;
  double duration_s() const { return duration_s_; }

  /// Shift of the channels' coordinates that moves the start of the body to the world's origin.
  const Vec3& worldShift() const { return shift_W_; }

 private:
  MotionChannels channels_;
  Rigid3 diver_from_body_;
  double duration_s_;
  Vec3 shift_W_ = Vec3::Zero();
};

/// Reading of a perfect IMU in the body frame; `gravity_W` points down (0, 0, -9.8).
ImuSample perfectImuSample(const MotionState& state, Time time, const Vec3& gravity_W);

/// Length of the body's path between two instants, m, from the speed at 20 Hz.
double pathLength(const Motion& motion, double begin_s, double end_s);

}  // namespace lodeline

#pragma once

#include <span>
#include <vector>

#include "lodeline/geometry/types.h"
#include "lodeline/sensors/measurements.h"

namespace lodeline {

/// How the body turned over a whole recording, from the gyroscope alone: orientation relative to the first
/// reading, to be asked for at any time in between. Over a step the rate is linear in time
/// (RotationIncrement).
class GyroscopePath {
 public:
  struct Point {
    Quat start_from_body = Quat::Identity();
    /// start_from_body(b + d) = start_from_body(b) * exp(by_bias * d) to first order in the bias change d.
    Mat3 by_bias = Mat3::Zero();           ///< s
    Vec3 rate_B = Vec3::Zero();            ///< without the bias, rad/s
    Vec3 specific_force_B = Vec3::Zero();  ///< as read, m/s^2
  };

  /// Throws InputError as requireUsable() does. The readings must outlive the path.
  GyroscopePath(std::span<const ImuSample> samples, const Vec3& gyroscope_bias_B);

  bool covers(Time time) const;
  /// Only for a time that is covered.
  Point at(Time time) const;
  /// Time within (from, to) without readings, beyond four usual steps, s.
  double gap_s(Time from, Time to) const;

 private:
  std::span<const ImuSample> samples_;
  Vec3 bias_;
  std::vector<Point> points_;  ///< at the readings
  struct Gap {
    Time begin, end;
  };
  std::vector<Gap> gaps_;
};

}  // namespace lodeline

#pragma once

#include <span>
#include <vector>

#include "lodeline/rig.h"
#include "lodeline/types.h"

namespace lodeline {

/// Orientation of the body over a whole recording, integrated from the gyroscope alone. It is relative to the
/// first reading and available at any time in between. Over a step, the rate is linear in time
/// (RotationIncrement).
class GyroscopePath {
 public:
  struct Point {
    Quat start_from_body = Quat::Identity();
    /// Derivative by the bias: start_from_body(b + d) = start_from_body(b) * exp(by_bias * d) to first order
    /// in d, s.
    Mat3 by_bias = Mat3::Zero();           ///< s
    Vec3 rate_B = Vec3::Zero();            ///< without bias, rad/s
    Vec3 specific_force_B = Vec3::Zero();  ///< as measured, m/s^2
  };

  /// Throws InputError like requireUsable(). The readings must outlive the path.
  GyroscopePath(std::span<const ImuSample> samples, const Vec3& gyroscope_bias_B);

  bool covers(Time time) const;
  /// Interpolated point; `time` must be covered.
  Point at(Time time) const;
  /// Total time within (from, to) without readings, counted beyond four usual steps, s.
  double gap_s(Time from, Time to) const;

 private:
  std::span<const ImuSample> samples_;
  Vec3 bias_;
  std::vector<Point> points_;  ///< at the times of the readings
  struct Gap {
    Time begin, end;
  };
  std::vector<Gap> gaps_;
};

}  // namespace lodeline

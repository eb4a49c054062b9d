#pragma once

#include <optional>
#include <vector>

#include "lodeline/rig.h"

namespace lodeline {

/// Attitude of the body by the gyroscope, and the integral of the specific force in the axes of the first
/// reading. Both drift; they are compared with other sensors within windows of seconds.
class InertialPath {
 public:
  /// `imu`: in order of time, rad/s and m/s^2.
  InertialPath(const std::vector<ImuSample>& imu, const Vec3& gyroscope_bias_B);

  /// Rotation from the body to the axes of the first reading; empty beyond the readings.
  std::optional<Mat3> attitude(Time time) const;
  /// Integral of the specific force since the first reading, m/s, gravity included; empty beyond the
  /// readings.
  std::optional<Vec3> forceIntegral(Time time) const;
  /// Angular velocity without bias, rad/s.
  std::optional<Vec3> rate_B(Time time) const;

 private:
  /// A place between two readings.
  struct Place {
    size_t after = 0;
    double share = 0.0;
  };
  std::optional<Place> find(Time time) const;

  std::vector<Time> times_;
  std::vector<Quat> attitudes_;
  std::vector<Vec3> force_integrals_;
  std::vector<Vec3> rates_B_;
};

/// Median rate of the gyroscope, as an estimate of its bias; zero where it is too large for one.
Vec3 medianRate_B(const std::vector<ImuSample>& imu);

}  // namespace lodeline

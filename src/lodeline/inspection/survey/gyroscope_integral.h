#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lodeline/rig.h"

namespace lodeline {

/// Mean rate of the gyroscope over any time span. Readings must be in order of time.
class GyroscopeIntegral {
 public:
  explicit GyroscopeIntegral(std::span<const ImuSample> samples);

  /// Mean rate over [begin_s, end_s], seconds after origin(), rad/s; empty beyond the readings.
  std::optional<Vec3> meanRate_B(double begin_s, double end_s) const;
  Time origin() const { return origin_; }

 private:
  std::optional<Vec3> angle_B(double time_s) const;

  Time origin_;
  std::vector<double> times_s_;
  std::vector<Vec3> angles_B_;  ///< integral of the rate, axis by axis
};

}  // namespace lodeline

#pragma once

#include <deque>
#include <optional>

#include "lodeline/estimator/pressure/depth_gate.h"
#include "lodeline/estimator/pressure/gauge_scale_check.h"
#include "lodeline/estimator/pressure/vertical_motion.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Monitors a depth gauge over many readings, used or not: whether it follows the rig's rise and fall, and
/// how much its readings scatter.
class GaugeMonitor {
 public:
  /// `stated_sigma_m`: sigma of a reading in the sensor's file.
  GaugeMonitor(const DepthGateOptions& options, double stated_sigma_m)
      : options_(options), stated_sigma_m_(stated_sigma_m) {}

  /// Checks the next reading in order of time, of a gauge with `lag_s`. `is_reliable`: whether `motion`, of
  /// the port, is known well enough to judge a gauge. Returns Used, Frozen or Slope.
  DepthStatus check(const DepthSample& reading, const VerticalMotion& motion, double lag_s, bool is_reliable);
  /// Adds the innovation of that reading, m; empty where the expectation is less accurate than the reading.
  void learnScatter(const std::optional<double>& innovation_m);

  /// Sigma of a reading, m: the stated one, or the observed one where that is larger.
  double readingSigma() const;
  std::optional<double> slope() const { return slope_.slope(); }

 private:
  DepthGateOptions options_;
  double stated_sigma_m_;
  std::deque<double> differences_m_;  ///< absolute differences of successive innovations
  GaugeScaleCheck slope_;
  std::optional<DepthSample> last_;
  std::optional<DepthSample> changed_;  ///< the first of the readings that repeat its value
  bool is_frozen_ = false;
  std::optional<double> last_innovation_m_;
};

}  // namespace lodeline

#pragma once

#include <deque>
#include <optional>

#include "lodeline/estimator/pressure/depth_gate.h"
#include "lodeline/estimator/pressure/gauge_scale_check.h"
#include "lodeline/estimator/pressure/vertical_motion.h"
#include "lodeline/sensors/measurements.h"

namespace lodeline {

/// Watches a depth gauge over many readings, used or not: whether it follows the rig's rise and fall, and how
/// much its readings scatter.
class GaugeMonitor {
 public:
  /// `stated_sigma_m`: of a reading, as its file says.
  GaugeMonitor(const DepthGateOptions& options, double stated_sigma_m)
      : options_(options), stated_sigma_m_(stated_sigma_m) {}

  /// The next reading in order of time, of a gauge with `lag_s`. `is_reliable`: whether `motion`, of the
  /// port, is known well enough to judge a gauge by. Used, Frozen or Slope.
  DepthStatus check(const DepthSample& reading, const VerticalMotion& motion, double lag_s, bool is_reliable);
  /// That reading less what is expected, m; nothing where the difference says more of what is expected.
  void learnScatter(const std::optional<double>& innovation_m);

  /// Sigma of a reading, m: as stated, or as seen where that is more.
  double readingSigma() const;
  std::optional<double> slope() const { return slope_.slope(); }

 private:
  DepthGateOptions options_;
  double stated_sigma_m_;
  std::deque<double> differences_m_;  ///< sizes, of successive innovations
  GaugeScaleCheck slope_;
  std::optional<DepthSample> last_;
  std::optional<DepthSample> changed_;  ///< the first of those that repeat its value
  bool is_frozen_ = false;
  std::optional<double> last_innovation_m_;
};

}  // namespace lodeline

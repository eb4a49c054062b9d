#pragma once

#include <optional>

#include "lodeline/estimator/options/depth_options.h"
#include "lodeline/util/time/time.h"

namespace lodeline {

/// What became of the pressure sensor in one frame.
enum class DepthStatus {
  Off,     ///< not asked for, or not on board
  NoData,  ///< no reading since the frame before
  Used,
  Jump,       ///< rejected: a spike, or the first readings after a step
  Restarted,  ///< used, from now on with another offset
  Frozen,     ///< rejected: the same reading again and again while the rig rises or sinks
  Slope,      ///< rejected: readings do not follow the rig's rise and fall, as in another unit
};
const char* toString(DepthStatus status);

struct DepthDecision {
  DepthStatus status = DepthStatus::NoData;
  bool use = false;
  /// Factor on the variance of a reading that is used though it disagrees.
  double variance_scale = 1.0;
};

/// Decides reading by reading whether a depth gauge is believed. Gauges fail by jumps (spikes, water hammer,
/// a driver's glitch, a new zero), odometry by creeping: so a reading that differs from what is expected is
/// rejected only if the one used before did not, and else used with a weight that falls with the difference,
/// so that it pulls no harder the further it is off. Readings rejected for `readmission_s` that have become
/// steady are taken for a gauge with another offset.
class DepthGate {
 public:
  explicit DepthGate(const DepthGateOptions& options) : options_(options) {}

  /// `innovation_m`: reading less what is expected; `sigma_m`: of that difference.
  DepthDecision decide(Time time, double innovation_m, double sigma_m);

 private:
  DepthGateOptions options_;
  double last_used_m_ = 0.0;  ///< innovation
  struct Rejection {
    Time since;
    /// Innovations of readings that stay within a limit of each other.
    Time steady_since;
    double least_m = 0.0, greatest_m = 0.0;
  };
  std::optional<Rejection> rejection_;
};

}  // namespace lodeline

#pragma once

#include <optional>

#include "lodeline/estimate.h"
#include "lodeline/problem/options/depth_options.h"
#include "lodeline/types.h"

namespace lodeline {

struct DepthDecision {
  DepthStatus status = DepthStatus::NoData;
  bool use = false;
  /// Factor on the variance of a reading that is used although it disagrees.
  double variance_scale = 1.0;
};

/// Decides for each reading whether a depth gauge is used. Gauges fail by jumps (spikes, water hammer, a
/// driver's fault, a new zero), while odometry drifts slowly. A reading with a large innovation is therefore
/// rejected only if the reading used before had a small one. Otherwise it is used with a weight that
/// decreases with the innovation, so that its influence does not grow with its error. Readings that were
/// rejected for `readmission_s` and have become steady are used with another offset.
class DepthGate {
 public:
  explicit DepthGate(const DepthGateOptions& options) : options_(options) {}

  /// `innovation_m`: reading minus expectation; `sigma_m`: sigma of that difference.
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

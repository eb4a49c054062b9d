#pragma once

#include <deque>
#include <optional>
#include <string>

#include "lodeline/util/time/time.h"

namespace lodeline {

/// How much a gauge's readings change for each metre that the rig sinks by its own estimate: 1 for depths in
/// metres. Tells another unit, a wrong sign or a blocked port. The median of some recent stretches of rise or
/// fall, so that neither offset, drift nor spikes matter.
class GaugeScaleCheck {
 public:
  /// One reading, in order of time; `rise_m`: of the port since the last call, upwards.
  void add(Time time, double depth, double rise_m);
  /// The estimate is of no use until the next call of add().
  void interrupt() { mark_.reset(); }

  /// Nothing as long as the rig has hardly risen or sunk.
  std::optional<double> slope() const;

 private:
  struct Mark {
    Time time;
    double depth = 0.0;
  };
  std::optional<Mark> mark_;
  double rise_since_mark_m_ = 0.0;
  std::deque<double> slopes_;
};

/// What a slope means, in words.
std::string explainSlope(double slope);

}  // namespace lodeline

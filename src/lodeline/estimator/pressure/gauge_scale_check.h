#pragma once

#include <deque>
#include <optional>
#include <string>

#include "lodeline/types.h"

namespace lodeline {

/// Slope of a gauge: change of its readings for each metre that the rig sinks by its own estimate, 1 for
/// depths in metres. It reveals another unit, a wrong sign or a blocked port. The slope is the median over
/// some recent sections of rise or fall, so that offset, drift and spikes do not matter.
class GaugeScaleCheck {
 public:
  /// Adds one reading, in order of time; `rise_m`: of the port since the last call, upwards.
  void add(Time time, double depth, double rise_m);
  /// Marks the estimated rise as unusable until the next call of add().
  void interrupt() { mark_.reset(); }

  /// Empty as long as the rig has hardly risen or sunk.
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

/// Explanation of a slope, in words.
std::string explainSlope(double slope);

}  // namespace lodeline

#pragma once

#include <string>
#include <string_view>

#include "lodeline/types.h"
#include "simulation/shared/random.h"

namespace lodeline {

/// Errors of a sensor's stamps relative to the IMU's time.
struct ClockErrors {
  double delay_s = 0.0;     ///< delay of the stamps
  double drift_ppm = 0.0;   ///< rate error of the sensor's clock, positive if fast
  double jitter_s = 0.0;    ///< standard deviation of each stamp
  double drop_share = 0.0;  ///< fraction of lost readings
};

/// Stamps a sensor's readings; stamps strictly increase for any jitter.
class SensorClock {
 public:
  SensorClock(const ClockErrors& errors, Time start, uint64_t seed, std::string_view sensor)
      : errors_(errors),
        start_(start),
        jitter_(seed, std::string(sensor) + "/jitter"),
        drops_(seed, std::string(sensor) + "/drops") {}

  /// The stamp of a reading taken at `time_s` after the start.
  Time stamp(double time_s);
  /// Whether the next reading is lost; call it once per reading.
  bool dropped() { return drops_.chance(errors_.drop_share); }

 private:
  ClockErrors errors_;
  Time start_;
  Random jitter_, drops_;
  bool started_ = false;
  Time last_;
};

}  // namespace lodeline

#include "simulation/sensors/sensor_clock.h"

#include <algorithm>

namespace lodeline {

Time SensorClock::stamp(double time_s) {
  const double jitter_s = errors_.jitter_s * jitter_.normal();
  Time stamp =
      start_ + Duration::fromSeconds(time_s * (1.0 + 1e-6 * errors_.drift_ppm) + errors_.delay_s + jitter_s);
  if (started_) stamp = std::max(stamp, last_ + Duration::fromNanoseconds(1000));
  started_ = true;
  last_ = stamp;
  return stamp;
}

}  // namespace lodeline

#include "lodeline/imu/sample_check.h"

#include <fmt/format.h>

#include "lodeline/diagnostics.h"

namespace lodeline {

void requireUsable(std::span<const ImuSample> samples, size_t fewest) {
  if (samples.size() < fewest) {
    throw InputError(
        fmt::format("at least {} IMU readings are needed, but there are {} in all", fewest, samples.size()));
  }
  for (size_t i = 0; i < samples.size(); ++i) {
    const int64_t ns = samples[i].time.nanoseconds();
    if (!samples[i].angular_velocity_B.allFinite() || !samples[i].specific_force_B.allFinite()) {
      throw InputError(fmt::format("IMU reading at {} ns holds a value that is not finite; drop it", ns));
    }
    if (i > 0 && samples[i].time <= samples[i - 1].time) {
      throw InputError(fmt::format(
          "IMU times must increase, but {} ns follows {} ns; sort the readings and drop repeated ones", ns,
          samples[i - 1].time.nanoseconds()));
    }
  }
}

}  // namespace lodeline

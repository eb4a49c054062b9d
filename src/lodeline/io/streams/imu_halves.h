#pragma once

#include <functional>
#include <optional>

#include "lodeline/rig.h"

namespace lodeline {

/// Merges the streams of a gyroscope and an accelerometer into one IMU. It gives one reading per gyroscope
/// reading, with the specific force interpolated linearly between the accelerometer's readings before and
/// after. It leaves out gyroscope readings outside of the accelerometer readings, and in their gaps longer
/// than four usual steps.
class ImuHalves {
 public:
  using Next = std::function<std::optional<ImuSample>()>;

  /// The next merged reading, from the next readings of both streams.
  std::optional<ImuSample> next(const Next& gyroscope, const Next& accelerometer);

 private:
  bool advance(const Next& accelerometer);

  std::optional<ImuSample> before_, after_;  ///< readings of the accelerometer
  std::optional<Duration> usual_step_;       ///< shortest seen so far
};

}  // namespace lodeline

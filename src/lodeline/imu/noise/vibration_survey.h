#pragma once

#include <span>

#include "lodeline/rig.h"

namespace lodeline {

/// Vibration in the readings of one inertial sensor, by its fastest part. For blocks of half a second, sigma
/// is the standard deviation that white noise with the same second differences would have:
///
///     sigma^2 = mean |x_(i+1) - 2 x_i + x_(i-1)|^2 / (3 * 6)
///
/// A smooth motion cancels in second differences.
struct Vibration {
  double strong = 0.0;        ///< sigma that a tenth of the blocks exceeds
  double quiet = 0.0;         ///< sigma that nine tenths exceed
  double share = 0.0;         ///< of the blocks whose sigma is beyond the limit
  double frequency_hz = 0.0;  ///< of the strongest line in the block that is stronger than nine tenths
  double rate_hz = 0.0;       ///< of the readings
};

/// `limit`: sigma beyond which a block counts. `samples` are in order of time; zero for less than 5 s of
/// them.
Vibration surveyVibration(std::span<const ImuSample> samples, Vec3 ImuSample::*reading, double limit);

}  // namespace lodeline

#pragma once

#include <span>

#include "lodeline/sensors/measurements.h"
#include "lodeline/sensors/rig.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// White noise of an IMU as its readings show it, densities as in ImuNoise; 0 where they do not.
struct WhiteNoise {
  double gyroscope_rad_per_s_sqrtHz = 0.0;
  double accelerometer_m_per_s2_sqrtHz = 0.0;
};

/// White noise in the quietest quarter of a second, from third differences of the readings x: their mean
/// square is 20 sigma^2 where the motion is smooth, and the density is sigma sqrt(h) at a period h. The
/// resolution's variance (least change)^2 / 12 counts in. Motors and hands shake more than any sensor's
/// noise: beyond 6e-4 rad/s/sqrt(Hz) and 0.01 m/s^2/sqrt(Hz), the worst that is sold for navigation, nothing
/// is said. `samples` in SI units, in order of time.
WhiteNoise whiteNoiseOf(std::span<const ImuSample> samples);

/// Noise densities that a sensor can have and that its readings do not contradict. Densities below those of
/// navigation-grade sensors (gyroscope 3e-7 rad/s/sqrt(Hz) = 0.001 deg/sqrt(h), accelerometer 1e-5
/// m/s^2/sqrt(Hz) = 1 ug/sqrt(Hz)), or below a third of what the readings show, are raised to the latter, and
/// to those of a common sensor (ImuNoise) where the readings show nothing. A bias whose random walk would
/// take five hours to outgrow the white noise gets that of a common sensor. Reports "imu_noise_too_small"
/// (warnings), and "imu_noise_too_large" (a notice) for eight times what the readings show.
ImuNoise plausibleNoise(const ImuNoise& stated, const WhiteNoise& shown, Diagnostics* diagnostics);

}  // namespace lodeline

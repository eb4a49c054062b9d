#pragma once

#include <span>

#include "lodeline/diagnostics.h"
#include "lodeline/rig.h"

namespace lodeline {

/// White noise densities estimated from the readings of an IMU, as in ImuNoise; 0 where undetermined.
struct WhiteNoise {
  double gyroscope_rad_per_s_sqrtHz = 0.0;
  double accelerometer_m_per_s2_sqrtHz = 0.0;
};

/// Estimates the white noise in the quietest quarter of a second from third differences of the readings x.
/// Where the motion is smooth, their mean square is 20 sigma^2, and the density is sigma sqrt(h) at a period
/// h. The resolution adds the variance (smallest change)^2 / 12. Motors and hands cause more vibration than
/// any sensor's noise. The result is therefore 0 beyond 6e-4 rad/s/sqrt(Hz) and 0.01 m/s^2/sqrt(Hz), the
/// largest values of sensors sold for navigation. `samples` are in SI units and in order of time.
WhiteNoise whiteNoiseOf(std::span<const ImuSample> samples);

/// Noise densities corrected to be physically possible and consistent with the readings. A density is
/// raised if it is below a third of the readings', or below that of navigation-grade sensors. These have
/// 3e-7 rad/s/sqrt(Hz) = 0.001 deg/sqrt(h) and 1e-5 m/s^2/sqrt(Hz) = 1 ug/sqrt(Hz). The new value is 1.5
/// times that of the readings, or that of a common sensor (ImuNoise) where the readings determine none.
/// Where the random walk of a bias would take five hours to exceed the white noise, it gets the value of
/// a common sensor. Reports "imu_noise_too_small" (warnings), and "imu_noise_too_large" (a notice) for
/// eight times the value of the readings.
ImuNoise plausibleNoise(const ImuNoise& stated, const WhiteNoise& shown, Diagnostics* diagnostics);

}  // namespace lodeline

#pragma once

#include <deque>
#include <span>

#include "lodeline/estimate.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Measures the vibration of motors in the inertial readings, as noise of the inertial terms. A vibration
/// near a multiple of the IMU's rate appears as a slow acceleration that no filter can tell from motion. The
/// fast part shows how strong it is. With second differences d of readings x at the period h,
///
///     d_i = x_(i+1) - 2 x_i + x_(i-1),   v = mean |d|^2 / (3 * 6),
///
/// v is the variance of white noise with these differences, of each axis. A smooth motion cancels. Thrust
/// changes the frequency, so over seconds the energy reaches all frequencies: noise of the density
///
///     sqrt(h (v - v_0)),   v_0 = (3 s)^2 / h
///
/// with the inflated density s of the calibration. Below v_0 there is none. The mean fades within two
/// seconds. It needs readings at even times, so that readings interpolated at frames do not count.
class VibrationMonitor {
 public:
  /// Adds no noise where the rig has no sensor of a vehicle, and so no motor. The same holds for an IMU
  /// faster than the vibrations of thrusters: 80 Hz and the double of it. These fold to slow ones only at a
  /// rate below.
  VibrationMonitor(const Rig& rig, double noise_inflation);

  /// The readings that lead to a frame, in order of time.
  void add(std::span<const ImuSample> readings);

  /// Noise beside that of the calibration.
  InertialDoubt doubt() const;

 private:
  /// Fading mean of the variance of one sensor.
  struct Shake {
    double variance = 0.0, weight = 0.0;
    void add(const Vec3& second_difference, double keep);
    double densityBeyond(double stated_density, double period_s) const;
  };

  bool is_active_;
  double period_s_;
  double stated_rate_density_, stated_force_density_;
  Shake rate_, force_;
  std::deque<ImuSample> last_;  ///< at most two
};

}  // namespace lodeline

#pragma once

namespace lodeline {

/// Options of the fusion of a Doppler velocity log (docs/theory/dvl.md).
struct DvlOptions {
  bool use = true;
  double noise_inflation = 1.0;  ///< factor on the stated noise of velocities
  /// Random walk of the scale (relative): the speed of sound changes with temperature and salinity.
  double scale_walk_per_sqrt_s = 5e-5;
  double robust_scale_sigmas = 2.0;  ///< width of the Cauchy loss
  /// A beam or a velocity is rejected beyond this number of sigmas of its innovation. The predicted speed has
  /// the sigma `speed_sigma` (relative) beside the covariance of the window.
  double max_sigmas = 4.0;
  double speed_sigma = 0.05;
  /// After this time without trust (DvlTrust), readings are used again with the noise that their disagreement
  /// shows: a prediction that is wrong by more than its covariance says must not lock the sensor out.
  double readmission_s = 10.0;

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

}  // namespace lodeline

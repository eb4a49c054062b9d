#pragma once

#include <array>
#include <optional>
#include <string>

#include "lodeline/imu/noise/allan_covariance.h"

namespace lodeline {

/// One noise coefficient with its uncertainty.
struct NoiseFigure {
  double value = 0.0;
  double sigma = 0.0;     ///< one sigma
  double at_most = 0.0;   ///< 95 % upper bound
  bool resolved = false;  ///< significant: its square is at least two sigmas above zero
};

/// Fitted noise coefficients. Densities are two-sided (Kalibr: a reading at rate f has sigma = density *
/// sqrt(f)); the square root of the one-sided spectrum is sqrt(2) times as large. [u]: unit of the reading.
struct NoiseFit {
  NoiseFigure quantization;  ///< Q, [u s]
  NoiseFigure white;         ///< N, [u/sqrt(Hz)]
  NoiseFigure instability;   ///< B, [u]; the minimum of the Allan deviation is 0.664 B
  NoiseFigure walk;          ///< K, [u/s/sqrt(Hz)]
  NoiseFigure ramp;          ///< R, [u/s]; zero unless the record requires it
  /// Shortest time constant of the instability (see flickerShare); zero unless the record requires more.
  double flicker_corner_s = 0.0;
  double shortest_s = 0.0;  ///< range of fitted averaging times
  double longest_s = 0.0;
  /// Mean squared residual in sigmas; about 1 where these noise processes explain the record.
  double misfit = 0.0;
  /// Below `shortest_s`, averaging reduces the noise less than for white noise: the sensor has a low-pass
  /// filter.
  bool is_filtered = false;
  /// No averaging time has the slope of white noise.
  bool lacks_white_region = false;

  /// Allan variance of the fitted noises.
  double variance(double tau_s) const;
  /// The random walk whose Allan deviation at `tau_s` equals that of walk and instability together, for
  /// filters whose model has no instability.
  double walkWithInstability(double tau_s) const;
};

struct NoiseFitOptions {
  /// Longest averaging time as a fraction of the record; beyond it, only one or two independent values
  /// remain.
  double longest_share = 0.25;
  /// Tolerance on the log-log slope of the Allan deviation within which the short end counts as white noise.
  double white_slope_tolerance = 0.15;
  /// Relative error of the noise model, of the variance.
  double model_error = 0.01;
  /// Minimum improvement for a fit with a ramp or a flicker corner: twice the logarithm of the likelihood
  /// ratio.
  double believed_gain = 12.0;
  double longest_corner_s = 30.0;
};

/// Fits the Allan variance of one axis (0 to 2) by generalized least squares with non-negative coefficients.
/// Without an axis, it fits the mean variance of all three, which has three times the information. The
/// weights are the inverse covariance from AllanCovariance for the fitted noise, found by iteration. They
/// account for the many certain values at short averaging times and the few correlated ones at long times.
/// Returns nothing for a curve of fewer than six octaves or of zeros.
std::optional<NoiseFit> fitNoise(const AllanCurve& curve, std::optional<int> axis,
                                 const NoiseFitOptions& options = {});

}  // namespace lodeline

#pragma once

#include <array>
#include <optional>
#include <string>

#include "lodeline/imu/noise/allan_covariance.h"

namespace lodeline {

/// One coefficient of noise with its uncertainty.
struct NoiseFigure {
  double value = 0.0;
  double sigma = 0.0;     ///< one sigma
  double at_most = 0.0;   ///< 95 % upper bound
  bool resolved = false;  ///< the record shows it: its square is at least two sigmas above zero
};

/// Densities are two-sided (Kalibr: a reading at rate f has sigma = density * sqrt(f)); the one-sided
/// spectrum's square root is sqrt(2) times as large. [u]: unit of the reading.
struct NoiseFit {
  NoiseFigure quantization;  ///< Q, [u s]
  NoiseFigure white;         ///< N, [u/sqrt(Hz)]
  NoiseFigure instability;   ///< B, [u]; the Allan deviation's floor is 0.664 B
  NoiseFigure walk;          ///< K, [u/s/sqrt(Hz)]
  NoiseFigure ramp;          ///< R, [u/s]; zero unless the record demands it
  /// The instability holds nothing faster than this (see flickerShare); zero unless the record demands more.
  double flicker_corner_s = 0.0;
  double shortest_s = 0.0;  ///< averaging times that were fitted
  double longest_s = 0.0;
  /// Mean squared misfit in sigmas; about 1 where these noises are all there is.
  double misfit = 0.0;
  /// Readings average less well than white noise below `shortest_s`: a low-pass filter in the sensor.
  bool is_filtered = false;
  /// No averaging time shows the slope of white noise.
  bool lacks_white_region = false;

  /// Allan variance of the fitted noises.
  double variance(double tau_s) const;
  /// The random walk that reaches the Allan deviation of walk and instability at `tau_s`: for filters that
  /// have no other place for the instability.
  double walkWithInstability(double tau_s) const;
};

struct NoiseFitOptions {
  /// Averaging times up to this share of the record; beyond, one or two independent values are left.
  double longest_share = 0.25;
  /// Slopes of the Allan deviation, in log-log, that count as white noise at the short end.
  double white_slope_tolerance = 0.15;
  /// Relative error that the model of the noise itself may have, of the variance.
  double model_error = 0.01;
  /// How much better a fit with a ramp, or with a corner of the flicker noise, must be before it is believed:
  /// twice the logarithm of the ratio of likelihoods.
  double believed_gain = 12.0;
  double longest_corner_s = 30.0;
};

/// Fits the Allan variance of one axis (0 to 2), or without an axis the mean variance of all three, which is
/// three times as certain, by generalized least squares with non-negative coefficients. The weights are the
/// inverse covariance that AllanCovariance gives for the fitted noises, found by iteration, so that neither
/// the many certain short averaging times nor the few, correlated long ones weigh more than they know.
/// Empty for a curve of fewer than six octaves, and for one that is all zero.
std::optional<NoiseFit> fitNoise(const AllanCurve& curve, std::optional<int> axis,
                                 const NoiseFitOptions& options = {});

}  // namespace lodeline

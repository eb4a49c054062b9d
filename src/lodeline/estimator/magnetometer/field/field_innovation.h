#pragma once

#include <optional>

#include "lodeline/ahrs/magnetometer_mean.h"
#include "lodeline/estimator/magnetometer/field/magnetometer_gate.h"
#include "lodeline/estimator/problem/covariance.h"
#include "lodeline/estimator/state/window.h"

namespace lodeline {

/// Measured against expected field, for the gate. What a gate decides by has to be known better than its
/// limits: the fields of a noisy sensor are averaged, in the world, over as many frames as bring its noise
/// down to MagnetometerGateOptions::field_sigma_T. Otherwise chance alone would reject one frame of a few
/// hundred, and never be quiet for long enough to be believed again.
class FieldInnovation {
 public:
  /// `options` must outlive it.
  explicit FieldInnovation(const MagnetometerOptions& options) : options_(options) {}

  /// Forgets the average.
  void restart() { measured_W_.reset(); }

  /// The newest frame's mean, with noise of `white_variance_T2` per axis.
  void add(const MagnetometerMean& mean, double white_variance_T2, const Window& window);

  /// What was added last against the field that the window expects, with its disturbance or without.
  /// `covariance`: of the frame before and the field's states. `correlated_noise_sigma_T`: lasting error of
  /// the field.
  FieldCheck check(const Window& window, const JointCovariance& covariance, double correlated_noise_sigma_T,
                   bool disturbed) const;

  /// Of the average, T^2 per axis.
  double whiteVariance() const { return white_variance_T2_; }

 private:
  Mat3 differenceCovariance(const Window& window, const JointCovariance& covariance, bool disturbed) const;

  const MagnetometerOptions& options_;
  MagnetometerMean newest_;
  std::optional<Vec3> measured_W_;  ///< average
  double white_variance_T2_ = 0.0;
};

}  // namespace lodeline

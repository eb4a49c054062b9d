#pragma once

#include <optional>
#include <vector>

#include "lodeline/ahrs/magnetometer_mean.h"
#include "lodeline/estimator/magnetometer/field/magnetometer_gate.h"
#include "lodeline/problem/covariance.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Innovation of the magnetometer for the gate: measured field compared with the expected one. The innovation
/// has to be known better than the limits of the gate. Fields of a noisy sensor are therefore averaged in
/// world axes over enough frames to reduce the noise to MagnetometerGateOptions::field_sigma_T. Otherwise
/// noise alone would reject one frame in a few hundred, and the field would never stay within the limits long
/// enough to be readmitted.
class FieldInnovation {
 public:
  /// `options` must outlive it.
  explicit FieldInnovation(const MagnetometerOptions& options) : options_(options) {}

  /// Discards the average.
  void restart() { measured_W_.reset(); }

  /// Adds the newest frame's mean, with white noise of `white_variance_T2` per axis. `currents_A`: mean
  /// currents at its readings, whose fields by the window's states are already subtracted (CurrentStates).
  void add(const MagnetometerMean& mean, double white_variance_T2, const Window& window,
           const std::vector<double>& currents_A = {});

  /// Compares the average, after the last add(), with the field that the window expects, with or without its
  /// disturbance. `covariance`: joint covariance of the frame before and the states of the field.
  /// `correlated_noise_sigma_T`: time-correlated error of the field.
  FieldCheck check(const Window& window, const JointCovariance& covariance, double correlated_noise_sigma_T,
                   bool disturbed) const;

  /// White noise of the average, T^2 per axis.
  double whiteVariance() const { return white_variance_T2_; }

 private:
  Mat3 differenceCovariance(const Window& window, const JointCovariance& covariance, bool disturbed) const;

  const MagnetometerOptions& options_;
  MagnetometerMean newest_;
  std::vector<double> currents_A_;  ///< at the readings of the newest mean
  std::optional<Vec3> measured_W_;  ///< average
  double white_variance_T2_ = 0.0;
};

}  // namespace lodeline

#pragma once

#include <optional>

#include "lodeline/base/time.h"
#include "lodeline/estimator/magnetometer_options.h"

namespace lodeline {

/// How far an undisturbed field is from the expected one for reasons that last: rock, currents, what
/// calibration leaves. Size and dip show it without asking for a heading.
///
/// Deviations are averaged over the time for which such errors last, so that each mean is one independent
/// witness of two components d, each of variance sigma^2 + v: sigma^2 of the floor, v of the prediction
/// (state and white noise). Given d, the floor's error has the expected square
///   (k d)^2 + (1 - k) sigma^2,   k = sigma^2 / (sigma^2 + v),
/// which is one step of expectation maximisation; sigma^2 is the mean of these squares and of a prior that
/// counts as `floor_prior_samples`, older ones fading with `floor_memory_s`.
class FieldFloor {
 public:
  explicit FieldFloor(const MagnetometerOptions& options) : options_(options), sigma_T_(options.floor_T) {}

  /// A reading that was believed. `along_T`, `dip_T`: measured minus expected field along the field and
  /// across it in its vertical plane; `state_variance_T2` of the expectation, `white_variance_T2` of the
  /// reading, per component.
  void add(Time time, double along_T, double dip_T, double state_variance_T2, double white_variance_T2);

  double sigma_T() const { return sigma_T_; }

 private:
  void learn();

  MagnetometerOptions options_;
  double sigma_T_;
  double squares_T2_ = 0.0;  ///< faded sum over the components
  double components_ = 0.0;  ///< and their number
  struct Mean {
    Time begin;
    int readings = 0;
    double along_T = 0.0, dip_T = 0.0, white_variance_T2 = 0.0;  ///< sums
    double state_variance_T2 = 0.0;                              ///< of the last
  };
  std::optional<Mean> mean_;
};

}  // namespace lodeline

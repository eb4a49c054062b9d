#pragma once

#include <optional>

#include "lodeline/problem/options/magnetometer_options.h"
#include "lodeline/types.h"

namespace lodeline {

/// Variance of the field's time-correlated error at this moment, from the deviation of size and dip. A field
/// that deviates much more than the floor, e.g. by a passing magnet below the limits of the gate, shows it in
/// size and dip. It then gets the variance that a Student distribution of `student_dof` degrees would give,
/// with both components as one draw. A deviation d with variance sigma^2 per component weighs like one of
/// variance (freedom sigma^2 + d^T d) / (freedom + 2). Source: Lange, Little, Taylor, "Robust statistical
/// modeling using the t distribution", JASA 1989.
class StudentTWeight {
 public:
  explicit StudentTWeight(const MagnetometerOptions& options) : options_(options) {}

  /// Adds a reading: measured minus expected field, along the field and across it in its vertical plane.
  /// `state_variance_T2`: variance of the expectation, `white_variance_T2`: of the reading, per component.
  void add(Time time, const Vec2& deviation_T, double state_variance_T2, double white_variance_T2);

  /// Sigma per axis of the time-correlated error, whose usual size is `correlated_noise_sigma_T`. The result
  /// is not smaller than that.
  double sigma_T(double correlated_noise_sigma_T) const;

  /// Mean deviation over the last `deviation_s`, T, and the variance of each component by state and noise.
  const Vec2& deviation_T() const { return mean_T_; }
  double variance_T2() const { return white_variance_T2_ + state_variance_T2_; }

 private:
  MagnetometerOptions options_;
  std::optional<Time> last_;
  Vec2 mean_T_ = Vec2::Zero();      ///< over the last `deviation_s`
  double white_variance_T2_ = 0.0;  ///< of this mean
  double state_variance_T2_ = 0.0;
  double excess_T2_ = 0.0;  ///< squared mean beyond the variance of state and noise
};

}  // namespace lodeline

#pragma once

#include <optional>

#include "lodeline/estimator/options/magnetometer_options.h"
#include "lodeline/util/time/time.h"

namespace lodeline {

/// How far size and dip of the field are from the expected ones at this moment. What errs much more than the
/// floor usually does - a passing magnet below the limits of the gate - says so by them, and is given as
/// much more variance as a Student distribution would: that of `student_dof` degrees, of which the two
/// components are one draw, weighs a deviation d of variance sigma^2 per component like one of variance
/// (freedom sigma^2 + d^T d) / (freedom + 2) (Lange, Little, Taylor, "Robust statistical modeling using the
/// t distribution", JASA 1989).
class StudentTWeight {
 public:
  explicit StudentTWeight(const MagnetometerOptions& options) : options_(options) {}

  /// A reading: measured minus expected field along the field and across it in its vertical plane.
  /// `state_variance_T2` of the expectation, `white_variance_T2` of the reading, per component.
  void add(Time time, const Vec2& deviation_T, double state_variance_T2, double white_variance_T2);

  /// One sigma per axis of a lasting error whose usual size is `correlated_noise_sigma_T`; not less than
  /// that.
  double sigma_T(double correlated_noise_sigma_T) const;

 private:
  MagnetometerOptions options_;
  std::optional<Time> last_;
  Vec2 mean_T_ = Vec2::Zero();      ///< over the last `deviation_s`
  double white_variance_T2_ = 0.0;  ///< of this mean
  double excess_T2_ = 0.0;          ///< its square beyond what state and noise account for
};

}  // namespace lodeline

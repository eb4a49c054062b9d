#pragma once

#include <optional>

#include "lodeline/magnetometer/iron/magnetometer_fit.h"

namespace lodeline {

/// Standard deviation of the compass heading due to calibration errors, rad, at a site with this dip,
/// averaged over all attitudes. The heading error is the field error along magnetic east divided by the
/// horizontal field F cos(dip). East is normal to the field, so a scale error has no effect:
///   sigma^2 = mean over directions u of trace((I - u u^T) P_m(u)) / (2 F^2 cos^2 dip),
/// with P_m the covariance of the corrected field in body axes. Where the covariance contains the rotation,
/// its errors and the uncertainty of the IMU's axes are included.
double headingSigma(const MagnetometerFit& fit, double dip_rad);

/// Difference between two calibrations of the same readings.
struct CalibrationDifference {
  Vec3 hard_iron = Vec3::Zero();        ///< second minus first, unit of the readings
  Mat3 iron_correction = Mat3::Zero();  ///< second minus first, both scaled to determinant 1
  std::optional<Vec3> rotation_rad;     ///< second = exp(this) first, body axes, where both have a rotation
  Eigen::Matrix<double, fit_parameter::kSize, 1> sigmas;  ///< from both covariances
  /// Equivalent heading difference at a dip, as in headingSigma(): RMS over all attitudes, and the maximum. A
  /// rotation that only one calibration has is used for both.
  double heading_rms_rad = 0.0;
  double heading_largest_rad = 0.0;
  /// Test statistic difference^T (covariance of the difference)^-1 difference over the parameters with a
  /// variance, and the number of these parameters. It is compared with the chi-square distribution.
  double chi_square = 0.0;
  int degrees_of_freedom = 0;
  bool significant = false;  ///< beyond the 99.7 % quantile
};
CalibrationDifference compareCalibrations(const MagnetometerFit& first, const MagnetometerFit& second,
                                          double dip_rad);

}  // namespace lodeline

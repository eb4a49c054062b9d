#pragma once

#include <optional>

#include "lodeline/magnetometer/iron/magnetometer_fit.h"

namespace lodeline {

/// What the errors of a calibration cost in heading: one sigma, rad, of the compass heading at a site with
/// this dip, over all attitudes. The heading turns by the error of the field along magnetic east divided by
/// the horizontal field F cos(dip); east is normal to the field, so an error of scale costs nothing:
///   sigma^2 = mean over directions u of trace((I - u u^T) P_m(u)) / (2 F^2 cos^2 dip),
/// with P_m the covariance of the corrected field in body axes. Errors of the rotation count where the
/// covariance has them, and with them the doubt about the IMU's axes.
double headingSigma(const MagnetometerFit& fit, double dip_rad);

/// How differently two calibrations correct the same readings.
struct CalibrationDifference {
  Vec3 hard_iron = Vec3::Zero();        ///< second minus first, unit of the readings
  Mat3 iron_correction = Mat3::Zero();  ///< second minus first, both scaled to determinant 1
  std::optional<Vec3> rotation_rad;     ///< second = exp(this) first, body axes, where both know it
  Eigen::Matrix<double, fit_parameter::kSize, 1> sigmas;  ///< of the differences, from both covariances
  /// Equivalent difference of heading over all attitudes at a dip, as in headingSigma(): RMS and the largest
  /// that an attitude can show. A rotation that only one of them knows is taken for that of both.
  double heading_rms_rad = 0.0;
  double heading_largest_rad = 0.0;
  /// difference^T (covariance of the difference)^-1 difference over the parameters with a variance, and their
  /// number: significant at the level where chi-square with so many degrees of freedom says so.
  double chi_square = 0.0;
  int degrees_of_freedom = 0;
  bool significant = false;  ///< beyond the 99.7 % quantile
};
CalibrationDifference compareCalibrations(const MagnetometerFit& first, const MagnetometerFit& second,
                                          double dip_rad);

}  // namespace lodeline

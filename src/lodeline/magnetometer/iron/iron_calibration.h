#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/magnetometer/iron/iron_fit.h"
#include "lodeline/magnetometer/iron/sphere_coverage.h"

namespace lodeline {

/// Requirements of an iron model on the data.
struct ModelRequirement {
  double coverage_share;
  double condition_number;
};

struct IronCalibrationOptions {
  /// Field magnitude at the place of the record, from a model of the Earth's field. Without it, A has
  /// determinant 1 (the sensor's own scale), and the offset alone cannot be fitted.
  std::optional<double> field_strength_T;
  double dip_rad = 1.047;  ///< dip for the equivalent heading error
  /// An older calibration. Its soft iron is used where the readings cannot determine it. All of it is kept
  /// where the readings determine nothing.
  std::optional<MagnetometerFit> old;
  bool raw_readings = false;

  int fewest_readings = 30;
  ModelRequirement full = {0.6, 1e3};
  ModelRequirement diagonal = {0.4, 1e4};
  ModelRequirement scale = {0.3, 1e4};
  ModelRequirement offset = {0.05, 1e4};
  double greatest_axis_ratio = 2.0;       ///< axis ratio of the ellipsoid; no usable sensor has a larger one
  double greatest_residual_share = 0.06;  ///< RMS of the residual divided by the field magnitude
  double greatest_rejected_share = 0.25;
  double greatest_heading_error_rad = 0.087;
};

struct IronCalibration {
  MagnetometerFit fit;                ///< without rotation, time offset and noise
  std::vector<bool> used;             ///< per reading; false for outliers
  SphereCoverage coverage;            ///< coverage of the used corrected readings
  std::vector<std::string> refusals;  ///< one sentence for each richer model that was rejected
  double correlation_factor = 1.0;
};

/// Estimates soft and hard iron from readings of a rotated sensor, in order of time and without repetitions.
/// The initial value is Li & Griffiths' ellipsoid; a robust geometric fit refines it. The result has the
/// richest model that coverage, condition number, residual and expected heading error allow; the last resort
/// is the old calibration. Throws EstimationError, with the reasons and how to move the sensor, where no
/// model is possible.
IronCalibration calibrateIron(std::span<const Vec3> readings, const IronCalibrationOptions& options);

/// Instruction for missing directions, e.g. "point the sensor's -z and +x sides into the field …".
std::string howToMove(const SphereCoverage& coverage);

/// Scales `fit` so that corrected readings have the magnitude `field_strength_T`. Without it, A gets
/// determinant 1 (readings in T), or the magnitude becomes 50 uT (raw readings). The covariance is scaled
/// too.
void settleScale(std::optional<double> field_strength_T, MagnetometerFit* fit);

}  // namespace lodeline

#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/magnetometer/iron/iron_fit.h"
#include "lodeline/magnetometer/iron/sphere_coverage.h"

namespace lodeline {

/// What a model must be given before it is trusted.
struct ModelRequirement {
  double coverage_share;
  double condition_number;
};

struct IronCalibrationOptions {
  /// Size of the field where the sensor was turned, from a model of the Earth's field; without it the
  /// sensor's own scale stands (A has determinant 1) and a fit of the offset alone is impossible.
  std::optional<double> field_strength_T;
  double dip_rad = 1.047;  ///< for the equivalent heading error
  /// An older calibration: its soft iron is used where the readings cannot tell theirs, and it is kept where
  /// they tell nothing.
  std::optional<MagnetometerFit> old;
  bool raw_readings = false;

  int fewest_readings = 30;
  ModelRequirement full = {0.6, 1e3};
  ModelRequirement diagonal = {0.4, 1e4};
  ModelRequirement scale = {0.3, 1e4};
  ModelRequirement offset = {0.05, 1e4};
  double greatest_axis_ratio = 2.0;       ///< of the ellipsoid; beyond it is no soft iron of a usable sensor
  double greatest_residual_share = 0.06;  ///< RMS of the residual by the field
  double greatest_rejected_share = 0.25;
  double greatest_heading_error_rad = 0.087;
};

struct IronCalibration {
  MagnetometerFit fit;                ///< without rotation, time offset and noise
  std::vector<bool> used;             ///< of the readings, false for outliers
  SphereCoverage coverage;            ///< of the corrected readings that were used
  std::vector<std::string> refusals;  ///< one sentence on each richer model that was passed over
  double correlation_factor = 1.0;
};

/// Soft and hard iron from readings of a sensor that was turned about, in order of time and free of
/// repetitions: Li & Griffiths' ellipsoid as the start, robust geometric refinement, and the richest model
/// that coverage, condition number, residual and expected heading error allow, down to keeping the old
/// calibration. Throws EstimationError, with the reasons and how to move the sensor, where nothing is left.
IronCalibration calibrateIron(std::span<const Vec3> readings, const IronCalibrationOptions& options);

/// What to do about missing directions, e.g. "point the sensor's -z and +x sides into the field …".
std::string howToMove(const SphereCoverage& coverage);

/// `fit` scaled so that corrected readings have the size `field_strength_T`, or, without one, so that A has
/// determinant 1 (readings in T) or the size is 50 uT (raw readings). The covariance follows.
void settleScale(std::optional<double> field_strength_T, MagnetometerFit* fit);

}  // namespace lodeline

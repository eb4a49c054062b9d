#include "lodeline/magnetometer/calibration/calibrate_magnetometer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/magnetometer/calibration/hard_iron_change.h"
#include "lodeline/magnetometer/calibration/heading/axis_checks.h"
#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"
#include "lodeline/magnetometer/iron/heading_error.h"
#include "lodeline/magnetometer/iron/reading_screen.h"
#include "lodeline/util/angles.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

constexpr double kAssumedDip_rad = 60.0 * kDegree;
/// Minimum distinctness; below it, the motion does not determine the rotation of the magnetometer.
constexpr double kLeastDistinctness = 4.0;
constexpr double kGreatestRotationSigma_rad = 2.0 * kDegree;
constexpr double kGreatestDipDifference_rad = 3.0 * kDegree;

double medianRate_hz(std::span<const MagnetometerSample> samples) {
  const double step_s = medianStep_s(samples);
  return step_s > 0.0 ? 1.0 / step_s : 0.0;
}

/// Readings used by the ellipsoid fit, raw and corrected, in units of the field magnitude.
struct UsedReadings {
  std::vector<NormalizedFieldSample> raw, corrected;
};
UsedReadings usedReadings(const std::vector<MagnetometerSample>& samples, const IronCalibration& iron) {
  UsedReadings used;
  const double strength_T = iron.fit.field_strength_T;
  // Scales counts of any size to order one; A contains the factor.
  const double unit = std::cbrt(iron.fit.iron_correction.determinant()) / strength_T;
  for (size_t i = 0; i < samples.size(); ++i) {
    if (!iron.used[i]) continue;
    used.raw.push_back({samples[i].time, samples[i].field_M * unit});
    used.corrected.push_back({samples[i].time, iron.fit.corrected_M(samples[i].field_M) / strength_T});
  }
  return used;
}

InertialCalibration withInertialSensors(const MagnetometerRecord& record, const UsedReadings& used,
                                        const IronCalibration& iron, bool has_old, Diagnostics* diagnostics) {
  if (record.imu.size() < 2) throw EstimationError("the recording has no gyroscope and accelerometer");
  const std::optional<FieldAlignment> alignment = alignField(used.corrected, record.imu);
  if (!alignment) throw EstimationError("hardly any magnetometer reading lies within the IMU's times");
  if (const auto objection = gyroscopeObjection(used.corrected, *alignment, record.imu)) {
    diagnostics->report(
        Severity::Serious, "gyroscope_axes",
        *objection + "; nothing of it is used here, and a run with these readings would fail");
    throw EstimationError(*objection);
  }
  if (alignment->distinctness < kLeastDistinctness) {
    throw EstimationError(
        "the sensor was not turned enough, or about one axis only, to tell how it sits on the IMU");
  }
  const double shape = std::cbrt(iron.fit.iron_correction.determinant());
  InertialParameters start;
  start.soft_iron = (iron.fit.iron_correction / shape).inverse();
  start.hard_iron = iron.fit.hard_iron * shape / iron.fit.field_strength_T;
  start.body_from_magnetometer = alignment->body_from_magnetometer;
  start.gyroscope_bias_B = alignment->gyroscope_bias_B;
  start.time_offset_s = alignment->time_offset_s;
  InertialCalibrationOptions options;
  options.model = iron.fit.model;
  if (has_old) options.left_out_scale_sigma = options.left_out_skew_sigma = 0.01;
  InertialCalibration result =
      calibrateWithInertialSensors(used.raw, record.imu, record.imu_noise, start, options);
  using namespace inertial_parameter;
  if (Eigen::LLT<Mat3>(result.parameters.soft_iron).info() != Eigen::Success) {
    throw EstimationError("the estimate with gyroscope and accelerometer makes no sense");
  }
  const double rotation_sigma_rad = std::sqrt(result.covariance.diagonal().segment<3>(kRotation).maxCoeff());
  if (!(rotation_sigma_rad < kGreatestRotationSigma_rad)) {
    throw EstimationError(fmt::format(
        "the rotation to the IMU is only known to {:.1f} degrees; turn the sensor about more axes",
        rotation_sigma_rad / kDegree));
  }
  return result;
}

/// Copies S, h and the rotation of the likelihood solution to the fit and determines its scale again.
void adopt(const InertialCalibration& inertial, std::optional<double> field_strength_T, double rate_hz,
           MagnetometerFit* fit) {
  using namespace inertial_parameter;
  const InertialParameters& p = inertial.parameters;
  const double shape = std::cbrt(fit->iron_correction.determinant());
  const double per_unit = fit->field_strength_T / shape;  // readings per unit of the likelihood solution
  const Mat3 a = p.soft_iron.inverse();
  // dA = -A dS A, entry by entry.
  Eigen::Matrix<double, fit_parameter::kSize, kSize> change =
      Eigen::Matrix<double, fit_parameter::kSize, kSize>::Zero();
  for (int i = 0; i < 6; ++i) {
    Eigen::Matrix<double, 6, 1> entry = Eigen::Matrix<double, 6, 1>::Zero();
    entry[i] = 1.0;
    change.block<6, 1>(fit_parameter::kIron, kSoftIron + i) =
        symmetricEntries(-a * symmetricMatrix(entry) * a) / per_unit;
  }
  change.block<3, 3>(fit_parameter::kHardIron, kHardIron) = per_unit * Mat3::Identity();
  change.block<3, 3>(fit_parameter::kRotation, kRotation).setIdentity();
  fit->iron_correction = a / per_unit;
  fit->hard_iron = per_unit * p.hard_iron;
  fit->body_from_magnetometer = p.body_from_magnetometer;
  fit->covariance = change * inertial.covariance * change.transpose();
  fit->field_strength_T = 1.0;
  settleScale(field_strength_T, fit);
  fit->dip_rad = p.dip_rad;
  fit->noise_density_T_per_sqrtHz =
      rate_hz > 0.0 ? std::optional(inertial.reading_sigma * fit->field_strength_T / std::sqrt(rate_hz))
                    : std::nullopt;
  fit->time_offset_sigma_s = inertial.time_offset_sigma_s;
  fit->time_offset_to_imu_s = inertial.time_offset_significant ? p.time_offset_s : 0.0;
}

/// RMS distance of the corrected readings from the sphere.
double normResidual_T(const MagnetometerCalibrationResult& result) {
  double square = 0.0;
  int count = 0;
  for (size_t i = 0; i < result.readings.size(); ++i) {
    if (!result.iron.used[i]) continue;
    square += std::pow(result.fit.corrected_M(result.readings[i]).norm() - result.fit.field_strength_T, 2);
    ++count;
  }
  return std::sqrt(square / std::max(1, count));
}

/// Noise density from the differences of neighbouring residuals, which slow model errors do not affect.
std::optional<double> noiseFromResiduals(const MagnetometerCalibrationResult& result, double rate_hz) {
  if (!(rate_hz > 0.0)) return std::nullopt;
  double square = 0.0;
  int count = 0;
  const MagnetometerFit& fit = result.fit;
  for (size_t i = 1; i < result.readings.size(); ++i) {
    if (!result.iron.used[i] || !result.iron.used[i - 1]) continue;
    square += std::pow(
        fit.corrected_M(result.readings[i]).norm() - fit.corrected_M(result.readings[i - 1]).norm(), 2);
    ++count;
  }
  if (count < 10 || !(square > 0.0)) return std::nullopt;
  return std::sqrt(square / (2.0 * count) / rate_hz);
}

void checkAgainstSite(const MagnetometerFit& fit, double own_strength_T, const Vec3& site_field_ENU,
                      Diagnostics* diagnostics) {
  const FieldElements site = fieldElements(site_field_ENU);
  if (fit.dip_rad && std::abs(*fit.dip_rad - site.inclination_rad) > kGreatestDipDifference_rad) {
    diagnostics->report(
        Severity::Warning, "magnetometer_dip",
        fmt::format("the field dips {:.1f} degrees where the site's dips {:.1f}: iron is near, the place is "
                    "wrong, or the sensor's axes are reversed or left-handed",
                    *fit.dip_rad / kDegree, site.inclination_rad / kDegree));
  }
  if (!fit.raw_readings && std::abs(own_strength_T / site.total_T - 1.0) > 0.1) {
    diagnostics->report(
        Severity::Warning, "magnetometer_scale",
        fmt::format("by the sensor's own scale the field has {:.1f} uT where the site's has {:.1f}: iron is "
                    "near, the place is wrong, or the sensor's scale is",
                    1e6 * own_strength_T, 1e6 * site.total_T));
  }
}

/// Inflates the covariance of the hard iron by its change during the record, and reports a step.
void judgeSteadiness(const std::vector<MagnetometerSample>& samples, MagnetometerCalibrationResult* result,
                     Diagnostics* diagnostics) {
  MagnetometerFit& fit = result->fit;
  std::vector<CorrectedReading> readings;
  for (size_t i = 0; i < samples.size(); ++i) {
    if (result->iron.used[i]) readings.push_back({samples[i].time, fit.corrected_M(samples[i].field_M)});
  }
  const HardIronChange change = findHardIronChange(readings, fit.field_strength_T);
  const Mat3 reading_by_field = fit.iron_correction.inverse();
  fit.covariance.block<3, 3>(fit_parameter::kHardIron, fit_parameter::kHardIron) +=
      change.spread_T * change.spread_T * reading_by_field * reading_by_field.transpose();
  if (!change.step) return;
  result->hard_iron_step_T = change.step->size_T;
  diagnostics->report(
      Severity::Warning, "magnetometer_current",
      fmt::format(
          "{:.0f} s after the first reading the hard iron changed at once by {:.2f} +- {:.2f} uT: a current "
          "on board was switched, or iron was moved. The calibration is a mean of both; repeat it with "
          "everything as it is on the dive",
          (change.step->time - samples.front().time).seconds(), 1e6 * change.step->size_T,
          1e6 * change.step->sigma_T));
}

std::string verdictOf(const MagnetometerCalibrationResult& result) {
  const MagnetometerFit& fit = result.fit;
  if (fit.model == IronModel::Kept)
    return "Not calibrated: these readings are no better than the old calibration, which is kept.";
  const double degrees = fit.heading_error_rad / kDegree;
  const bool knows_rotation = fit.body_from_magnetometer && result.inertial;
  const char* worth = degrees < 0.5 ? "Good" : degrees < 2.0 ? "Usable" : "Weak";
  std::string text = worth;
  if (!knows_rotation) text += " for the magnetometer alone";
  switch (fit.model) {
    case IronModel::Full:
      text += ": soft and hard iron are determined";
      break;
    case IronModel::Diagonal:
      text += ": three scales and the offset are determined, cross-axis soft iron is not";
      break;
    case IronModel::Scale:
      text += ": the offset is determined, soft iron is not";
      break;
    default:
      text += ": the offset alone is determined, from the field's known size";
      break;
  }
  if (knows_rotation) {
    text +=
        fmt::format(", and so is the rotation to the IMU. Expected heading error {:.2f} degrees.", degrees);
  } else {
    text += fmt::format(
        "; the rotation to the IMU is not. Expected heading error {:.2f} degrees if the rotation {} is "
        "exact; each "
        "degree that it is off costs up to {:.1f} degrees more.",
        degrees, fit.body_from_magnetometer ? "that the recording states" : "that the rig's file states",
        1.0 / std::cos(result.dip_rad));
  }
  if (fit.dip_rad && *fit.dip_rad < 0.0 && result.dip_source == "measured")
    text +=
        " That holds south of the magnetic equator; north of it headings are reversed, since the field dips "
        "up.";
  if (degrees >= 2.0) text += " Repeat with more directions before relying on it.";
  return text;
}

}  // namespace

MagnetometerCalibrationResult calibrateMagnetometer(const MagnetometerRecord& record,
                                                    const CalibrationOptions& options,
                                                    Diagnostics* diagnostics) {
  if (options.old && options.old->raw_readings != record.is_raw) {
    throw InputError("of the readings and the old calibration one is in raw counts and the other in tesla");
  }
  const ReadingScreen screen = screenReadings(record.magnetometer, diagnostics);
  if (screen.usable.size() < 2 && screen.repeated > 0) {
    throw EstimationError("the magnetometer was frozen: it gave the same reading all the time");
  }
  MagnetometerCalibrationResult result;
  for (const MagnetometerSample& sample : screen.usable) result.readings.push_back(sample.field_M);

  IronCalibrationOptions iron;
  iron.raw_readings = record.is_raw;
  iron.old = options.old;
  result.dip_rad = kAssumedDip_rad;
  result.dip_source = "assumed";
  if (options.site_field_ENU) {
    const FieldElements site = fieldElements(*options.site_field_ENU);
    iron.field_strength_T = site.total_T;
    result.dip_rad = site.inclination_rad;
    result.dip_source = "site";
  }
  iron.dip_rad = result.dip_rad;
  result.iron = calibrateIron(result.readings, iron);
  result.fit = result.iron.fit;
  result.coverage = result.iron.coverage;
  if (result.fit.model == IronModel::Kept) {
    result.without_inertial = "the old calibration is kept";
    result.fit.verdict = verdictOf(result);
    return result;
  }

  const double rate_hz = record.has_times ? medianRate_hz(screen.usable) : 0.0;
  result.fit.body_from_magnetometer = record.body_from_magnetometer;
  try {
    const UsedReadings used = usedReadings(screen.usable, result.iron);
    result.inertial = withInertialSensors(record, used, result.iron, options.old.has_value(), diagnostics);
    adopt(*result.inertial, iron.field_strength_T, rate_hz, &result.fit);
    // For an error D of the axes, (D - D^T) / 2 rotates all of them.
    result.fit.axes_sigma_rad = imu_axes::sigmaFor(record.imu_noise) / std::sqrt(2.0);
    result.fit.residual_T = normResidual_T(result);
    result.fit.rejected_share += (1.0 - result.fit.rejected_share) * result.inertial->rejected_share;
    if (!options.site_field_ENU) {
      result.dip_rad = *result.fit.dip_rad;
      result.dip_source = "measured";
    }
  } catch (const EstimationError& error) {
    result.without_inertial = error.what();
    result.fit.noise_density_T_per_sqrtHz = noiseFromResiduals(result, rate_hz);
  }
  checkAxes(result.fit, options.site_field_ENU, record.body_from_magnetometer, diagnostics);
  judgeSteadiness(screen.usable, &result, diagnostics);
  result.fit.heading_error_rad = headingSigma(result.fit, result.dip_rad);
  if (options.site_field_ENU) {
    const double own_strength_T =
        result.fit.field_strength_T / std::cbrt(result.fit.iron_correction.determinant());
    checkAgainstSite(result.fit, own_strength_T, *options.site_field_ENU, diagnostics);
  }
  result.fit.verdict = verdictOf(result);
  return result;
}

}  // namespace lodeline

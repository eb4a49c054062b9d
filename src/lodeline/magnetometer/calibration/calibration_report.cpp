#include "lodeline/magnetometer/calibration/calibration_report.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "lodeline/geometry/so3.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

using Sigmas = Eigen::Matrix<double, fit_parameter::kSize, 1>;

/// Unit of the readings in the report: uT, or counts.
struct Shown {
  double factor;
  const char* unit;
};
Shown shownReadings(const MagnetometerFit& fit) {
  return fit.raw_readings ? Shown{1.0, "counts"} : Shown{1e6, "uT"};
}

std::string ironRows(const MagnetometerFit& fit) {
  // Near one for readings in T; otherwise in nT per count.
  const double factor = fit.raw_readings ? 1e9 : 1.0;
  const Mat3 a = factor * fit.iron_correction;
  const Mat3 s = factor * symmetricMatrix(fit.sigmas().head<6>());
  std::string text;
  for (int row = 0; row < 3; ++row) {
    text += fmt::format("  {:<18}{:9.5f} {:9.5f} {:9.5f}   +- {:.5f} {:.5f} {:.5f}\n",
                        row == 0 ? (fit.raw_readings ? "A (nT/count)" : "A") : "", a(row, 0), a(row, 1),
                        a(row, 2), s(row, 0), s(row, 1), s(row, 2));
  }
  return text;
}

std::string inertialRows(const MagnetometerCalibrationResult& result) {
  const MagnetometerFit& fit = result.fit;
  std::string text;
  if (!result.inertial) {
    text += fmt::format("  without gyroscope: {}\n", result.without_inertial);
    return text;
  }
  const InertialCalibration& inertial = *result.inertial;
  const Vec3 turn = so3::log(*fit.body_from_magnetometer) / kDegree;
  const Vec3 sigma = fit.sigmas().tail<3>() / kDegree;
  text += fmt::format(
      "  {:<18}{:9.3f} {:9.3f} {:9.3f}   +- {:.3f} {:.3f} {:.3f} degrees (rotation vector, M to B)\n",
      "rotation to IMU", turn.x(), turn.y(), turn.z(), sigma.x(), sigma.y(), sigma.z());
  text += fmt::format("  {:<18}+- {:.3f} degrees each against the body, beyond that; no motion tells\n",
                      "axes of the IMU", fit.axes_sigma_rad / kDegree);
  text += fmt::format("  {:<18}{:.1f} +- {:.1f} ms behind the gyroscope{}\n", "lag",
                      -1e3 * inertial.measured_time_offset_s, 1e3 * inertial.time_offset_sigma_s,
                      inertial.time_offset_significant ? "" : " (not significant, not used)");
  text += fmt::format("  {:<18}{:.2f} degrees\n", "dip", *fit.dip_rad / kDegree);
  if (inertial.gyroscope_noise_factor > 3.0) {
    text += fmt::format(
        "  {:<18}{:.0f} times what its noise density explains (scale, vibration, or an uneven field)\n",
        "gyroscope errors", inertial.gyroscope_noise_factor);
  }
  return text;
}

}  // namespace

std::string calibrationText(const MagnetometerCalibrationResult& result) {
  const MagnetometerFit& fit = result.fit;
  const Shown shown = shownReadings(fit);
  const Vec3 h = shown.factor * fit.hard_iron;
  const Vec3 sigma = shown.factor * fit.sigmas().segment<3>(fit_parameter::kHardIron);
  std::string text = fit.verdict + "\n";
  for (const std::string& refusal : result.iron.refusals) text += "  " + refusal + "\n";
  if (!result.iron.refusals.empty()) text += howToMove(result.coverage) + "\n";
  text += fmt::format("  {:<18}{:9.3f} {:9.3f} {:9.3f}   +- {:.3f} {:.3f} {:.3f} {}\n", "hard iron h", h.x(),
                      h.y(), h.z(), sigma.x(), sigma.y(), sigma.z(), shown.unit);
  text += ironRows(fit);
  if (fit.model == IronModel::Kept) return text;
  text += inertialRows(result);
  text += fmt::format("  {:<18}{:.3f} uT ({})\n", "field", 1e6 * fit.field_strength_T,
                      fit.field_strength_known ? "of the site"
                      : fit.raw_readings       ? "assumed: raw counts tell no size"
                                               : "by the sensor's own scale");
  text += fmt::format("  {:<18}{:.3f} uT, {:.2f} % of the field, over {} readings\n", "residual",
                      1e6 * fit.residual_T, 100.0 * fit.residual_T / fit.field_strength_T, fit.readings);
  if (fit.noise_density_T_per_sqrtHz) {
    text += fmt::format("  {:<18}{:.4f} uT/sqrt(Hz), two-sided\n", "noise",
                        1e6 * *fit.noise_density_T_per_sqrtHz);
  }
  text += fmt::format("  {:<18}{:.0f} % of the sphere\n", "coverage", 100.0 * fit.coverage_share);
  text += fmt::format("  {:<18}{:.3g}\n", "condition number", fit.condition_number);
  const auto left_out = std::count(result.iron.used.begin(), result.iron.used.end(), false);
  text += fmt::format("  {:<18}{:.1f} % ({} of {} readings did not fit the ellipsoid)\n", "rejected",
                      100.0 * fit.rejected_share, left_out, result.iron.used.size());
  if (result.hard_iron_step_T) {
    text += fmt::format("  {:<18}changed at once by {:.2f} uT during the record\n", "hard iron",
                        1e6 * *result.hard_iron_step_T);
  }
  text += fmt::format("  {:<18}{:.3f} degrees, one sigma, at a dip of {:.1f} degrees ({})\n", "heading error",
                      fit.heading_error_rad / kDegree, result.dip_rad / kDegree, result.dip_source);
  return text;
}

namespace {

nlohmann::ordered_json jsonRows(const Mat3& matrix) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (int r = 0; r < 3; ++r) rows.push_back({matrix(r, 0), matrix(r, 1), matrix(r, 2)});
  return rows;
}

nlohmann::ordered_json jsonList(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

nlohmann::ordered_json calibrationJson(const MagnetometerCalibrationResult& result) {
  const MagnetometerFit& fit = result.fit;
  const Sigmas sigmas = fit.sigmas();
  const std::string h = fit.raw_readings ? "hard_iron_raw" : "hard_iron_T";
  nlohmann::ordered_json json;
  json["verdict"] = fit.verdict;
  json["model"] = toString(fit.model);
  json["passed_over"] = result.iron.refusals;
  json["iron_correction"] = jsonRows(fit.iron_correction);
  json["iron_correction_sigma"] = jsonRows(symmetricMatrix(sigmas.head<6>()));
  json[h] = jsonList(fit.hard_iron);
  json[h + "_sigma"] = jsonList(sigmas.segment<3>(fit_parameter::kHardIron));
  if (fit.body_from_magnetometer) {
    json["rotation_body_from_magnetometer"] = jsonRows(fit.body_from_magnetometer->toRotationMatrix());
  }
  json["rotation_estimated"] = result.inertial.has_value();
  if (result.inertial) {
    const InertialCalibration& inertial = *result.inertial;
    json["rotation_sigma_rad"] = jsonList(sigmas.tail<3>());
    json["axes_sigma_rad"] = fit.axes_sigma_rad;
    json["time_offset_measured_s"] = inertial.measured_time_offset_s;
    json["time_offset_sigma_s"] = inertial.time_offset_sigma_s;
    json["time_offset_used"] = inertial.time_offset_significant;
    json["dip_rad"] = *fit.dip_rad;
    json["gyroscope_bias_rad_per_s"] = jsonList(inertial.parameters.gyroscope_bias_B);
    json["gyroscope_noise_factor"] = inertial.gyroscope_noise_factor;
    json["residual_correlation_factor"] = inertial.correlation_factor;
  } else {
    json["rotation_not_estimated_because"] = result.without_inertial;
    json["residual_correlation_factor"] = result.iron.correlation_factor;
  }
  if (fit.noise_density_T_per_sqrtHz) json["noise_density_T_per_sqrtHz"] = *fit.noise_density_T_per_sqrtHz;
  json["field_strength_T"] = fit.field_strength_T;
  json["field_strength_known"] = fit.field_strength_known;
  json["residual_T"] = fit.residual_T;
  json["residual_percent"] = 100.0 * fit.residual_T / fit.field_strength_T;
  json["coverage_percent"] = 100.0 * fit.coverage_share;
  json["condition_number"] = fit.condition_number;
  json["rejected_percent"] = 100.0 * fit.rejected_share;
  if (result.hard_iron_step_T) json["hard_iron_step_T"] = *result.hard_iron_step_T;
  json["readings"] = fit.readings;
  json["heading_error_deg"] = fit.heading_error_rad / kDegree;
  json["heading_error_dip_deg"] = result.dip_rad / kDegree;
  json["heading_error_dip_source"] = result.dip_source;
  return json;
}

std::string comparisonText(const MagnetometerFit& first, const MagnetometerFit& second, double dip_rad) {
  const CalibrationDifference d = compareCalibrations(first, second, dip_rad);
  const Shown shown = shownReadings(first);
  const Vec3 h = shown.factor * d.hard_iron;
  const Vec3 h_sigma = shown.factor * d.sigmas.segment<3>(fit_parameter::kHardIron);
  const Eigen::Matrix<double, 6, 1> a = symmetricEntries(d.iron_correction);
  std::string text = "second calibration minus first\n";
  text += fmt::format("  {:<18}{:9.3f} {:9.3f} {:9.3f}   +- {:.3f} {:.3f} {:.3f} {}\n", "hard iron h", h.x(),
                      h.y(), h.z(), h_sigma.x(), h_sigma.y(), h_sigma.z(), shown.unit);
  const char* const names[6] = {"A xx", "A yy", "A zz", "A xy", "A xz", "A yz"};
  for (int i = 0; i < 6; ++i) {
    text += fmt::format("  {:<18}{:9.3f}   +- {:.3f} %\n", names[i], 100.0 * a[i], 100.0 * d.sigmas[i]);
  }
  if (d.rotation_rad) {
    const Vec3 turn = *d.rotation_rad / kDegree;
    const Vec3 sigma = d.sigmas.tail<3>() / kDegree;
    text += fmt::format("  {:<18}{:9.3f} {:9.3f} {:9.3f}   +- {:.3f} {:.3f} {:.3f} degrees\n", "rotation",
                        turn.x(), turn.y(), turn.z(), sigma.x(), sigma.y(), sigma.z());
  }
  text +=
      fmt::format("  {:<18}differs by {:.2f} degrees RMS, {:.2f} at worst, at a dip of {:.1f} degrees\n",
                  "heading", d.heading_rms_rad / kDegree, d.heading_largest_rad / kDegree, dip_rad / kDegree);
  if (d.degrees_of_freedom == 0)
    return text + "No standard deviations are known: nothing to judge the difference by.\n";
  text += fmt::format("The difference is {}significant (chi-square {:.1f} with {} degrees of freedom).\n",
                      d.significant ? "" : "not ", d.chi_square, d.degrees_of_freedom);
  return text;
}

nlohmann::ordered_json comparisonJson(const MagnetometerFit& first, const MagnetometerFit& second,
                                      double dip_rad) {
  const CalibrationDifference d = compareCalibrations(first, second, dip_rad);
  nlohmann::ordered_json json;
  json["hard_iron_difference"] = jsonList(d.hard_iron);
  json["hard_iron_sigma"] = jsonList(d.sigmas.segment<3>(fit_parameter::kHardIron));
  json["iron_correction_difference"] = jsonRows(d.iron_correction);
  if (d.rotation_rad) json["rotation_difference_rad"] = jsonList(*d.rotation_rad);
  json["heading_rms_deg"] = d.heading_rms_rad / kDegree;
  json["heading_largest_deg"] = d.heading_largest_rad / kDegree;
  json["dip_deg"] = dip_rad / kDegree;
  json["chi_square"] = d.chi_square;
  json["degrees_of_freedom"] = d.degrees_of_freedom;
  json["significant"] = d.significant;
  return json;
}

}  // namespace lodeline

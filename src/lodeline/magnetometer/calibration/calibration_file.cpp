#include "lodeline/magnetometer/calibration/calibration_file.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <fstream>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/yaml_file.h"

namespace lodeline {
namespace {

template <typename Matrix>
std::string rows(const Matrix& matrix) {
  std::string text;
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    text += "\n  - [";
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) text += fmt::format("{}{}", c ? ", " : "", matrix(r, c));
    text += "]";
  }
  return text + "\n";
}

std::string list(const Vec3& v) { return fmt::format("[{}, {}, {}]\n", v.x(), v.y(), v.z()); }

/// A verdict as one quoted line.
std::string quotedLine(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result + "\"\n";
}

std::string sensorKeys(const MagnetometerFit& fit) {
  std::string text;
  if (fit.body_from_magnetometer) {
    text += "# rotation R_B_M of magnetometer axes into body (IMU) axes\nrotation_body_from_magnetometer:" +
            rows(fit.body_from_magnetometer->toRotationMatrix());
  }
  if (fit.time_offset_to_imu_s) {
    text += fmt::format(
        "# stamps + this = IMU clock; negative where the magnetometer lags\n"
        "time_offset_to_imu_s: {}\n",
        *fit.time_offset_to_imu_s);
  }
  if (fit.time_offset_sigma_s) text += fmt::format("time_offset_sigma_s: {}\n", *fit.time_offset_sigma_s);
  if (fit.noise_density_T_per_sqrtHz) {
    text += fmt::format(
        "# two-sided, sigma of a reading = density * sqrt(rate)\n"
        "noise_density_T_per_sqrtHz: {}\n",
        *fit.noise_density_T_per_sqrtHz);
  }
  if (fit.dip_rad) text += fmt::format("# measured, below the horizon\ndip_rad: {}\n", *fit.dip_rad);
  return text;
}

void requireSymmetricPositive(const Mat3& a, const std::string& where) {
  const double size = a.cwiseAbs().maxCoeff();
  if (!a.allFinite() || (a - a.transpose()).cwiseAbs().maxCoeff() > 1e-6 * size) {
    throw InputError(where +
                     " must be a symmetric matrix; a rotation belongs into "
                     "rotation_body_from_magnetometer");
  }
  const Vec3 eigenvalues = Eigen::SelfAdjointEigenSolver<Mat3>(a).eigenvalues();
  if (eigenvalues.minCoeff() <= 1e-3 * eigenvalues.maxCoeff()) {
    throw InputError(where + " must be positive definite and far from singular");
  }
}

std::optional<double> optionalNumber(const std::string& key, CalibrationMap* map) {
  if (!map->has(key)) return std::nullopt;
  return map->number(key);
}

void readIron(CalibrationMap* map, MagnetometerFit* fit) {
  fit->raw_readings = map->has("hard_iron_raw");
  if (fit->raw_readings && map->has("hard_iron_T")) {
    throw InputError(map->atLine("hard_iron_T") + " contradicts hard_iron_raw; keep the one that is valid");
  }
  const char* const hard_iron = fit->raw_readings ? "hard_iron_raw" : "hard_iron_T";
  fit->hard_iron = map->vector3(hard_iron);
  if (!fit->hard_iron.allFinite()) throw InputError(map->atLine(hard_iron) + " must be finite");
  fit->iron_correction = map->matrix3("iron_correction");
  requireSymmetricPositive(fit->iron_correction, map->atLine("iron_correction"));
}

void readRotation(CalibrationMap* map, MagnetometerFit* fit) {
  const std::string key = "rotation_body_from_magnetometer";
  if (!map->has(key)) return;
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = map->matrix3(key);
  fit->body_from_magnetometer = Rigid3::fromMatrix(matrix, map->atLine(key).c_str()).rotation;
}

void readCovariance(CalibrationMap* map, MagnetometerFit* fit) {
  if (!map->has("covariance")) return;
  const std::vector<double> values = map->numbers("covariance");
  constexpr int kSize = fit_parameter::kSize;
  if (values.size() != kSize * kSize) {
    throw InputError(fmt::format("{} has {} numbers where a {}x{} matrix needs {}", map->atLine("covariance"),
                                 values.size(), kSize, kSize, kSize * kSize));
  }
  fit->covariance = Eigen::Map<const Eigen::Matrix<double, kSize, kSize, Eigen::RowMajor>>(values.data());
}

}  // namespace

std::string calibrationYaml(const MagnetometerFit& fit) {
  std::string text = "# Magnetometer calibration: the field in magnetometer axes is A (reading - h).\n";
  text += "verdict: " + quotedLine(fit.verdict);
  text += fmt::format("# full, diagonal, scale, offset or kept\nmodel: {}\n", toString(fit.model));
  text += "# A, symmetric\niron_correction:" + rows(fit.iron_correction);
  text += fit.raw_readings ? "# h, counts\nhard_iron_raw: " : "# h\nhard_iron_T: ";
  text += list(fit.hard_iron) + sensorKeys(fit);
  text += fmt::format(
      "# size of corrected readings; known from a model of the Earth's field, or the sensor's scale\n"
      "field_strength_T: {}\nfield_strength_known: {}\n",
      fit.field_strength_T, fit.field_strength_known);
  text += fmt::format(
      "residual_T: {}\ncoverage_percent: {}\ncondition_number: {}\nrejected_percent: {}\n"
      "readings: {}\n# one sigma\nheading_error_rad: {}\n",
      fit.residual_T, 100.0 * fit.coverage_share, fit.condition_number, 100.0 * fit.rejected_share,
      fit.readings, fit.heading_error_rad);
  text +=
      "# of A (xx yy zz xy xz yz), h and the rotation (rad, body axes)\ncovariance:" + rows(fit.covariance);
  text += fmt::format("# of the IMU's axes against the body, each; no motion tells\naxes_sigma_rad: {}\n",
                      fit.axes_sigma_rad);
  return text;
}

void writeCalibrationFile(const MagnetometerFit& fit, const std::filesystem::path& file) {
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream << calibrationYaml(fit);
  stream.close();
  if (!stream) {
    throw InputError(fmt::format("{}: cannot be written; check the folder and its rights", file.string()));
  }
}

MagnetometerFit readCalibrationFile(const std::filesystem::path& file) {
  CalibrationMap map(loadYamlFile(file), file, "");
  MagnetometerFit fit;
  readIron(&map, &fit);
  readRotation(&map, &fit);
  readCovariance(&map, &fit);
  if (map.has("model")) fit.model = ironModelFromString(map.text("model"), map.atLine("model"));
  if (map.has("verdict")) fit.verdict = map.text("verdict");
  fit.time_offset_to_imu_s = optionalNumber("time_offset_to_imu_s", &map);
  fit.time_offset_sigma_s = optionalNumber("time_offset_sigma_s", &map);
  fit.noise_density_T_per_sqrtHz = optionalNumber("noise_density_T_per_sqrtHz", &map);
  if (fit.noise_density_T_per_sqrtHz && !(*fit.noise_density_T_per_sqrtHz > 0.0)) {
    throw InputError(map.atLine("noise_density_T_per_sqrtHz") + " must be positive");
  }
  fit.dip_rad = optionalNumber("dip_rad", &map);
  fit.field_strength_T = map.numberOr("field_strength_T", 0.0);
  fit.field_strength_known = map.has("field_strength_known") && map.text("field_strength_known") == "true";
  fit.residual_T = map.numberOr("residual_T", 0.0);
  fit.coverage_share = map.numberOr("coverage_percent", 0.0) / 100.0;
  fit.condition_number = map.numberOr("condition_number", 0.0);
  fit.rejected_share = map.numberOr("rejected_percent", 0.0) / 100.0;
  fit.readings = static_cast<int>(map.numberOr("readings", 0.0));
  fit.heading_error_rad = map.numberOr("heading_error_rad", 0.0);
  fit.axes_sigma_rad = map.numberOr("axes_sigma_rad", 0.0);
  map.refuseUnknownKeys();
  return fit;
}

void applyCalibration(const MagnetometerFit& fit, const std::filesystem::path& file, Rig* rig) {
  if (!rig->magnetometer) {
    throw InputError(file.string() +
                     ": a magnetometer calibration, but the recording has no magnetometer readings "
                     "(mav0/mag0/data.csv); leave the calibration out");
  }
  if (fit.raw_readings) {
    throw InputError(
        file.string() +
        ": made from raw counts, while a recording holds tesla; calibrate from readings in a unit "
        "of the field (--unit)");
  }
  MagnetometerCalibration& magnetometer = *rig->magnetometer;
  magnetometer.iron_correction = fit.iron_correction;
  magnetometer.hard_iron_T = fit.hard_iron;
  magnetometer.is_calibrated = true;
  if (fit.body_from_magnetometer) magnetometer.body_from_magnetometer.rotation = *fit.body_from_magnetometer;
  if (fit.noise_density_T_per_sqrtHz)
    magnetometer.noise_density_T_per_sqrtHz = *fit.noise_density_T_per_sqrtHz;
  if (fit.time_offset_to_imu_s) magnetometer.time_offset_to_imu_s = *fit.time_offset_to_imu_s;
  if (fit.field_strength_T > 0.0) magnetometer.field_strength_T = fit.field_strength_T;
  const auto rmsSigma = [&](int begin) {
    return std::sqrt(fit.covariance.diagonal().segment<3>(begin).cwiseMax(0.0).mean());
  };
  const double hard_iron_sigma_T = rmsSigma(fit_parameter::kHardIron);
  const double rotation_sigma_rad = std::hypot(rmsSigma(fit_parameter::kRotation), fit.axes_sigma_rad);
  if (hard_iron_sigma_T > 0.0) magnetometer.hard_iron_sigma_T = hard_iron_sigma_T;
  if (rotation_sigma_rad > 0.0) magnetometer.rotation_sigma_rad = rotation_sigma_rad;
}

}  // namespace lodeline

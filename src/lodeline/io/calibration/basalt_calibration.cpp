#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/calibration_translation.h"

namespace lodeline {
namespace {

Rigid3 readPose(CalibrationMap* map) {
  const Quat rotation(map->number("qw"), map->number("qx"), map->number("qy"), map->number("qz"));
  if (!(std::abs(rotation.norm() - 1.0) < 1e-3)) {
    throw InputError(fmt::format("{}: qx qy qz qw is no unit quaternion", map->at("qw")));
  }
  return Rigid3(rotation.normalized(), Vec3(map->number("px"), map->number("py"), map->number("pz")));
}

YAML::Node basaltCamera(CalibrationMap* map, const YAML::Node& resolution) {
  YAML::Node camera;
  const std::string type = map->text("camera_type");
  std::optional<CalibrationMap> numbers = map->section("intrinsics");
  if (!numbers) throw InputError(map->at("intrinsics") + " is missing");
  camera["resolution"] = resolution;
  const CameraModel* model = findCameraModel(type);
  if (model == nullptr) {
    throw InputError(
        fmt::format("{} is '{}', a camera model that Lodeline does not have; calibrate with "
                    "`basalt_calibrate --cam-types kb4` (or ds, eucm, pinhole-radtan8)",
                    map->atLine("camera_type"), type));
  }
  setCameraModel(*model, &camera);
  std::vector<std::string> before(model->parameters.begin(), model->parameters.end());
  const auto first_coefficient = before.begin() + static_cast<std::ptrdiff_t>(model->before_focal_lengths);
  const std::vector<std::string> coefficients(first_coefficient, before.end());
  before.erase(first_coefficient, before.end());
  before.insert(before.end(), {"fx", "fy", "cx", "cy"});
  camera["intrinsics"] = numbersUnder(before, &*numbers);
  if (!coefficients.empty()) camera["distortion_coefficients"] = numbersUnder(coefficients, &*numbers);
  return camera;
}

/// The largest of the values of three axes.
std::string largest(const std::string& key, CalibrationMap* map) {
  const YAML::Node node = map->node()[key];
  const std::vector<double> values = node.IsScalar() ? std::vector{map->number(key)} : map->numbers(key);
  if (values.empty()) throw InputError(map->atLine(key) + " holds no number");
  return fmt::format("{}", *std::max_element(values.begin(), values.end()));
}

/// Converts Basalt's model, calibrated = (I + S) reading - b, to that of a rig file. It writes reading = M
/// calibrated + bias with M = (I + S)^-1 to `section`.
void setCorrection(const Mat3& scale, const Vec3& bias, YAML::Node* section) {
  if (scale.isZero(0.0) && bias.isZero(0.0)) return;
  const Mat3 axes = (Mat3::Identity() + scale).inverse();
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = axes;
  const Vec3 in_reading = axes * bias;
  (*section)["M"] = numberList({rows.data(), rows.data() + rows.size()});
  (*section)["bias"] = numberList({in_reading.x(), in_reading.y(), in_reading.z()});
}

std::vector<double> countedNumbers(const std::string& key, size_t count, CalibrationMap* map) {
  if (!map->has(key)) return std::vector<double>(count, 0.0);
  numbersAsWritten(key, count, map);
  return map->numbers(key);
}

YAML::Node basaltImu(CalibrationMap* map) {
  YAML::Node imu;
  imu["gyroscope_noise_density"] = largest("gyro_noise_std", map);
  imu["gyroscope_random_walk"] = largest("gyro_bias_std", map);
  imu["accelerometer_noise_density"] = largest("accel_noise_std", map);
  imu["accelerometer_random_walk"] = largest("accel_bias_std", map);
  if (map->has("imu_update_rate")) imu["rate_hz"] = map->text("imu_update_rate");
  const std::vector<double> gyroscope = countedNumbers("calib_gyro_bias", 12, map);
  const std::vector<double> accelerometer = countedNumbers("calib_accel_bias", 9, map);
  Mat3 lower = Mat3::Zero();
  lower.col(0) = Vec3(accelerometer.data() + 3);
  lower.col(1).tail<2>() = Vec2(accelerometer.data() + 6);
  lower(2, 2) = accelerometer[8];
  YAML::Node gyroscopes, accelerometers;
  setCorrection(Eigen::Map<const Mat3>(gyroscope.data() + 3), Vec3(gyroscope.data()), &gyroscopes);
  setCorrection(lower, Vec3(accelerometer.data()), &accelerometers);
  if (gyroscopes.size() > 0) imu["gyroscopes"] = gyroscopes;
  if (accelerometers.size() > 0) imu["accelerometers"] = accelerometers;
  return imu;
}

}  // namespace

TranslatedSections translateBasalt(CalibrationMap* root) {
  std::optional<CalibrationMap> inner = root->section("value0");
  CalibrationMap* map = inner ? &*inner : root;
  const YAML::Node poses = map->node()["T_imu_cam"];
  const YAML::Node cameras = map->node()["intrinsics"];
  const YAML::Node resolutions = map->node()["resolution"];
  if (poses.size() != cameras.size() || resolutions.size() != cameras.size()) {
    throw InputError(fmt::format("{}: {} poses, {} intrinsics, {} resolutions; one of each a camera is due",
                                 map->file().string(), poses.size(), cameras.size(), resolutions.size()));
  }
  TranslatedSections sections;
  for (size_t i = 0; i < cameras.size(); ++i) {
    CalibrationMap pose(poses[i], map->file(), fmt::format("T_imu_cam[{}]", i));
    CalibrationMap camera(cameras[i], map->file(), fmt::format("intrinsics[{}]", i));
    YAML::Node& section = sections[fmt::format("cam{}", i)];
    section = basaltCamera(&camera, resolutions[i]);
    section["T_BS"] = transformNode(readPose(&pose));
    if (map->has("cam_time_offset_ns")) {
      section["timeshift_cam_imu"] = fmt::format("{}", map->number("cam_time_offset_ns") * 1e-9);
    }
  }
  sections["imu0"] = basaltImu(map);
  return sections;
}

}  // namespace lodeline

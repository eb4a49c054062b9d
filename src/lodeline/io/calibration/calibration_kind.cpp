#include "lodeline/io/calibration/calibration_kind.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <vector>

#include "lodeline/io/calibration/yaml_file.h"
#include "lodeline/sensors/sensor_kind.h"
#include "lodeline/util/edit_distance.h"

namespace lodeline {
namespace {

bool hasAllKeys(const YAML::Node& node, std::initializer_list<const char*> keys) {
  return std::all_of(keys.begin(), keys.end(), [&](const char* key) { return node[key].IsDefined(); });
}

/// Whether a key is the section of a rig, also with one wrong letter in its name.
bool isAlmostSensor(const std::string& key, const YAML::Node& value) {
  if (isSensorName(key)) return true;
  if (!value.IsMap()) return false;
  if (editDistance(key, "cam0") <= 1 || editDistance(key, "cam1") <= 1) return true;
  return std::any_of(kSingleSensors.begin(), kSingleSensors.end(),
                     [&](const char* sensor) { return editDistance(key, sensor) <= 1; });
}

bool isRig(const YAML::Node& root) {
  return std::any_of(root.begin(), root.end(), [](const auto& entry) {
    return entry.first.IsScalar() && isAlmostSensor(entry.first.Scalar(), entry.second);
  });
}

bool isList(const YAML::Node& node, const char* key) {
  return hasAnyKey(node, {key}) && node[key].IsSequence();
}

bool isOkvis(const YAML::Node& root) {
  return isList(root, "cameras") && root["cameras"].size() > 0 && hasAnyKey(root["cameras"][0], {"T_SC"});
}

bool isBasalt(const YAML::Node& root) {
  const YAML::Node value = root["value0"].IsDefined() ? root["value0"] : root;
  return isList(value, "T_imu_cam") && isList(value, "intrinsics");
}

const char* otherKind(const YAML::Node& root) {
  if (hasAnyKey(root, {"iron_correction", "hard_iron_T", "hard_iron_raw"})) {
    return "a magnetometer calibration: give it with --mag-calibration";
  }
  if (hasAnyKey(root, {"front_end", "inertial", "window", "magnetometer", "source"})) {
    return "settings of Lodeline: give them with -c";
  }
  if (hasAnyKey(root, {"rosbag2_bagfile_information"})) return "the description of a ROS 2 bag";
  if (isList(root, "cameras")) return "perhaps a camera rig of maplab or SVO, which is not read";
  if (hasAnyKey(root, {"target_type"})) return "a calibration target of Kalibr, not its result";
  if (hasAnyKey(root, {"M1", "D1", "cameraMatrix", "R1", "P1"})) {
    return "perhaps a stereo calibration by OpenCV, which does not know the IMU";
  }
  return nullptr;
}

}  // namespace

bool isCameraName(const std::string& key) {
  const bool has_leading_zero = key.size() > 4 && key[3] == '0';
  return key.size() > 3 && key.size() < 7 && key.starts_with("cam") && !has_leading_zero &&
         std::all_of(key.begin() + 3, key.end(), [](char c) { return c >= '0' && c <= '9'; });
}

bool isSensorName(const std::string& key) {
  return isCameraName(key) ||
         std::find(kSingleSensors.begin(), kSingleSensors.end(), key) != kSingleSensors.end();
}

CalibrationKind recognizeCalibration(const YAML::Node& root) {
  if (!root.IsMap()) return CalibrationKind::Other;
  if (isOkvis(root)) return CalibrationKind::Okvis;
  if (isBasalt(root)) return CalibrationKind::Basalt;
  if (hasAnyKey(root, {"relative_config_imu", "relative_config_imucam"}))
    return CalibrationKind::OpenVinsEstimator;
  if (hasAnyKey(root, {"body_T_cam0", "cam0_calib", "extrinsicRotation"})) return CalibrationKind::Vins;
  if (hasAnyKey(root, {"Camera.type", "Camera.fx", "Camera1.fx"})) return CalibrationKind::OrbSlam;
  if (hasAnyKey(root, {"gyroscope_noise_density", "accelerometer_noise_density"}))
    return CalibrationKind::ImuKeys;
  if (hasAllKeys(root, {"intrinsics", "resolution"})) return CalibrationKind::CameraKeys;
  if (hasAllKeys(root, {"model_type", "image_width"})) return CalibrationKind::VinsCamera;
  if (hasAllKeys(root, {"camera_matrix"}) || hasAllKeys(root, {"width", "K"}) ||
      hasAllKeys(root, {"width", "k"})) {
    return CalibrationKind::CameraInfo;
  }
  return isRig(root) ? CalibrationKind::Rig : CalibrationKind::Other;
}

const char* describe(CalibrationKind kind) {
  switch (kind) {
    case CalibrationKind::Rig:
      return "a rig file, or a calibration by Kalibr or OpenVINS";
    case CalibrationKind::ImuKeys:
      return "the calibration of an IMU";
    case CalibrationKind::CameraKeys:
      return "the calibration of one camera in EuRoC's keys";
    case CalibrationKind::OpenVinsEstimator:
      return "a configuration of OpenVINS";
    case CalibrationKind::Vins:
      return "a configuration of VINS-Fusion or VINS-Mono";
    case CalibrationKind::VinsCamera:
      return "a camera of VINS-Fusion";
    case CalibrationKind::OrbSlam:
      return "settings of ORB-SLAM3";
    case CalibrationKind::Okvis:
      return "a configuration of OKVIS";
    case CalibrationKind::Basalt:
      return "a calibration by Basalt";
    case CalibrationKind::CameraInfo:
      return "the calibration of one camera as ROS (camera_info) or OpenCV writes it";
    case CalibrationKind::Other:
      break;
  }
  return "no calibration that Lodeline knows";
}

std::string describeOther(const YAML::Node& root) {
  constexpr size_t kMostKeys = 6;
  const char* what = root.IsMap() ? otherKind(root) : nullptr;
  std::string text = "holds no sensors (cam0, imu0, mag0, …) and is no calibration that Lodeline knows";
  if (what != nullptr) return fmt::format("{}; it is {}", text, what);
  std::vector<std::string> keys;
  if (root.IsMap()) {
    for (const auto& entry : root) {
      if (entry.first.IsScalar() && keys.size() < kMostKeys) keys.push_back(entry.first.Scalar());
    }
    text += fmt::format(" (its keys: {}{})", fmt::join(keys, ", "), root.size() > kMostKeys ? ", …" : "");
  }
  return text +
         "; give a rig file (`lodeline rig-template` prints one to fill in), Kalibr's camchain-imucam.yaml "
         "and "
         "imu.yaml, or a calibration of OpenVINS, VINS-Fusion, ORB-SLAM3, OKVIS or Basalt";
}

}  // namespace lodeline

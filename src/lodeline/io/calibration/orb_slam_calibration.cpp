#include <fmt/core.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/calibration_translation.h"

namespace lodeline {
namespace {

/// The transformation under a key, given as 12 or 16 numbers.
Rigid3 transformOf(const std::string& key, CalibrationMap* root) {
  const std::vector<double> numbers = root->numbers(key);
  if (numbers.size() != 12 && numbers.size() != 16) {
    throw InputError(
        fmt::format("{} has {} numbers where a transform needs 12 or 16", root->atLine(key), numbers.size()));
  }
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (int i = 0; i < 12; ++i) matrix(i / 4, i % 4) = numbers[static_cast<size_t>(i)];
  return Rigid3::fromMatrix(matrix, root->atLine(key).c_str());
}

/// The first existing key of several; the first one where none exists.
std::string firstPresent(std::initializer_list<const char*> keys, CalibrationMap* root) {
  for (const char* key : keys) {
    if (root->has(key)) return key;
  }
  return *keys.begin();
}

YAML::Node orbNumbers(const std::string& prefix, std::vector<std::string> names, CalibrationMap* root) {
  for (std::string& name : names) name.insert(0, prefix);
  return numbersUnder(names, root);
}

YAML::Node orbCamera(const std::string& prefix, const std::string& type, CalibrationMap* root) {
  YAML::Node camera;
  camera["resolution"] = orbNumbers("Camera.", {"width", "height"}, root);
  camera["intrinsics"] = orbNumbers(prefix, {"fx", "fy", "cx", "cy"}, root);
  const bool is_distorted = type == "PinHole" && root->has(prefix + "k1");
  const CameraModel& model = *findCameraModel(is_distorted ? "radial-tangential" : type);
  setCameraModel(model, &camera);
  std::vector<std::string> coefficients(model.parameters.begin(), model.parameters.end());
  if (is_distorted) coefficients.resize(root->has(prefix + "k3") ? 5 : 4);
  if (!coefficients.empty()) camera["distortion_coefficients"] = orbNumbers(prefix, coefficients, root);
  if (root->has("Camera.fps") && root->number("Camera.fps") > 0.0)
    camera["rate_hz"] = root->text("Camera.fps");
  return camera;
}

/// Transformation from camera 2 to camera 1; nothing for settings of one camera.
std::optional<Rigid3> firstFromSecond(const std::string& prefix, const std::string& type,
                                      CalibrationMap* root) {
  const std::string key = firstPresent({"Stereo.T_c1_c2", "Tlr"}, root);
  if (type != "Rectified" && root->has(key)) return transformOf(key, root);
  if (root->has("Stereo.b")) return Rigid3(Quat::Identity(), Vec3(root->number("Stereo.b"), 0.0, 0.0));
  const bool has_depth_images = root->has("DepthMapFactor") || root->has("RGBD.DepthMapFactor");
  if (has_depth_images || !root->has("Camera.bf")) return std::nullopt;
  const double baseline_m = root->number("Camera.bf") / root->number(prefix + "fx");
  return Rigid3(Quat::Identity(), Vec3(baseline_m, 0.0, 0.0));
}

YAML::Node orbImu(CalibrationMap* root) {
  YAML::Node imu;
  for (const auto& [ours, theirs] : {std::pair("gyroscope_noise_density", "IMU.NoiseGyro"),
                                     std::pair("gyroscope_random_walk", "IMU.GyroWalk"),
                                     std::pair("accelerometer_noise_density", "IMU.NoiseAcc"),
                                     std::pair("accelerometer_random_walk", "IMU.AccWalk")}) {
    root->number(theirs);
    imu[ours] = root->text(theirs);
  }
  if (root->has("IMU.Frequency")) imu["rate_hz"] = root->text("IMU.Frequency");
  return imu;
}

}  // namespace

TranslatedSections translateOrbSlam(CalibrationMap* root) {
  if (root->has("LEFT.K")) {
    throw InputError(
        root->atLine("LEFT.K") +
        ": settings of version 0 for images to be rectified, which leave open of which camera Tbc is; use "
        "those of version 1.0 (Camera1.fx, Camera2.fx, Stereo.T_c1_c2, IMU.T_b_c1)");
  }
  const std::string type = root->text("Camera.type");
  if (type != "PinHole" && type != "KannalaBrandt8" && type != "Rectified") {
    throw InputError(fmt::format("{} is '{}'; known are PinHole, KannalaBrandt8 and Rectified",
                                 root->atLine("Camera.type"), type));
  }
  const std::string key = firstPresent({"IMU.T_b_c1", "Tbc"}, root);
  if (!root->has(key)) {
    throw InputError(
        root->at(key) +
        " is missing: settings without an IMU; give those of the stereo- or monocular-inertial mode");
  }
  const std::string first = root->has("Camera1.fx") ? "Camera1." : "Camera.";
  TranslatedSections sections;
  sections["cam0"] = orbCamera(first, type, root);
  const Rigid3 body_from_first = transformOf(key, root);
  sections["cam0"]["T_BS"] =
      root->numbers(key).size() == 16 ? numbersAsWritten(key, 16, root) : transformNode(body_from_first);
  if (const std::optional<Rigid3> first_from_second = firstFromSecond(first, type, root)) {
    sections["cam1"] = orbCamera(root->has("Camera2.fx") ? "Camera2." : first, type, root);
    sections["cam1"]["T_BS"] = transformNode(body_from_first * *first_from_second);
  }
  sections["imu0"] = orbImu(root);
  return sections;
}

}  // namespace lodeline

#include "lodeline/data/kalibr_calibration.h"

#include <fmt/core.h>

#include <algorithm>

#include "lodeline/base/error.h"
#include "lodeline/data/camera_keys.h"
#include "lodeline/data/imu_keys.h"
#include "lodeline/data/yaml_file.h"

namespace lodeline {
namespace {

bool isCamchain(const std::string& stem) { return stem.find("camchain-imucam") != std::string::npos; }

bool isImu(const std::string& stem) {
  return stem == "imu" || stem == "imu0" || stem.starts_with("imu-") || stem.ends_with("-imu");
}

std::optional<std::filesystem::path> findOne(const std::filesystem::path& folder,
                                             bool (*matches)(const std::string& stem)) {
  std::vector<std::filesystem::path> found;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const bool yaml = entry.path().extension() == ".yaml" || entry.path().extension() == ".yml";
    if (yaml && entry.is_regular_file() && matches(entry.path().stem().string())) {
      found.push_back(entry.path());
    }
  }
  std::sort(found.begin(), found.end());
  if (found.empty()) return std::nullopt;
  if (found.size() > 1) {
    throw InputError(fmt::format("{} and {} both look like Kalibr's result; keep the one that is valid",
                                 found[0].string(), found[1].filename().string()));
  }
  return found[0];
}

Rigid3 readCameraFromBody(const std::vector<CameraCalibration>& before, CalibrationMap* map) {
  map->ignore({"T_cn_cnm1"});
  if (map->has("T_cam_imu")) return map->transform("T_cam_imu");
  if (before.empty() || !map->has("T_cn_cnm1")) {
    throw InputError(
        map->at("T_cam_imu") +
        " is missing: this is a camera-only calibration. Run kalibr_calibrate_imu_camera and use "
        "its camchain-imucam.yaml");
  }
  return map->transform("T_cn_cnm1") * before.back().body_from_camera.inverse();
}

}  // namespace

KalibrFiles findKalibrFiles(const std::vector<std::filesystem::path>& folders) {
  KalibrFiles files;
  for (const std::filesystem::path& folder : folders) {
    if (!files.camchain) files.camchain = findOne(folder, isCamchain);
    if (!files.imu) files.imu = findOne(folder, isImu);
  }
  return files;
}

CameraCalibration readKalibrCamera(const std::vector<CameraCalibration>& before, CalibrationMap* map) {
  map->ignore({"cam_overlaps", "rostopic", "camera_model"});
  CameraCalibration camera;
  camera.name = fmt::format("cam{}", before.size());
  readPinhole("distortion_coeffs", map, &camera);
  camera.body_from_camera = readCameraFromBody(before, map).inverse();
  camera.time_offset_to_imu_s = map->numberOr("timeshift_cam_imu", 0.0);
  camera.rate_hz = 0.0;
  return camera;
}

ImuCalibration readKalibrImu(CalibrationMap* map) {
  map->ignore({"T_i_b", "rostopic", "model", "time_offset"});
  ImuCalibration imu;
  imu.noise = readImuNoise(map);
  imu.rate_hz = map->numberOr("update_rate", 0.0);
  return imu;
}

std::vector<CameraCalibration> readKalibrCameras(const std::filesystem::path& file,
                                                 Diagnostics* diagnostics) {
  const YAML::Node root = loadYamlFile(file);
  std::vector<CameraCalibration> cameras;
  for (size_t i = 0; root.IsMap() && root[fmt::format("cam{}", i)].IsDefined(); ++i) {
    const std::string name = fmt::format("cam{}", i);
    CalibrationMap map(root[name], file, name);
    cameras.push_back(readKalibrCamera(cameras, &map));
    map.reportUnknownKeys(diagnostics);
  }
  if (cameras.empty()) {
    throw InputError(fmt::format("{}: key 'cam0' is missing; this is not Kalibr's camchain", file.string()));
  }
  return cameras;
}

ImuCalibration readKalibrImu(const std::filesystem::path& file, Diagnostics* diagnostics) {
  const YAML::Node root = loadYamlFile(file);
  const bool nested = root.IsMap() && root["imu0"].IsDefined();
  CalibrationMap map(nested ? root["imu0"] : root, file, nested ? "imu0" : "");
  const ImuCalibration imu = readKalibrImu(&map);
  map.reportUnknownKeys(diagnostics);
  return imu;
}

}  // namespace lodeline

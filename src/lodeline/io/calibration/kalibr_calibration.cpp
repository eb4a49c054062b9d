#include "lodeline/io/calibration/kalibr_calibration.h"

#include <fmt/core.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/camera_keys.h"
#include "lodeline/io/calibration/imu_keys.h"

namespace lodeline {
namespace {

Rigid3 readBodyFromCamera(const CameraCalibration* before, CalibrationMap* map) {
  map->ignore({"T_cn_cnm1"});
  const bool has_forward = map->has("T_cam_imu");
  if (map->has("T_imu_cam")) {
    const Rigid3 body_from_camera = map->transform("T_imu_cam");
    if (!has_forward) return body_from_camera;
    const Rigid3 difference = map->transform("T_cam_imu") * body_from_camera;
    if (difference.translation.norm() > 1e-3 || difference.rotation.vec().norm() > 1e-3) {
      throw InputError(
          fmt::format("{} is not the inverse of T_cam_imu; remove the wrong one", map->atLine("T_imu_cam")));
    }
  }
  if (has_forward) return map->transform("T_cam_imu").inverse();
  if (before != nullptr && map->has("T_cn_cnm1")) {
    return before->body_from_camera * map->transform("T_cn_cnm1").inverse();
  }
  throw InputError(map->at("T_cam_imu") +
                   " is missing, and so is its inverse T_imu_cam: this is a camera-only calibration. Run "
                   "kalibr_calibrate_imu_camera and use its camchain-imucam.yaml");
}

}  // namespace

bool isKalibrCamera(const YAML::Node& section) {
  return hasAnyKey(section, {"T_cam_imu", "T_imu_cam", "T_cn_cnm1", "distortion_coeffs"});
}

bool isKalibrImu(const YAML::Node& section) {
  return hasAnyKey(section, {"update_rate", "T_i_b", "rostopic", "Tw", "Ta"});
}

CameraCalibration readKalibrCamera(int number, const CameraCalibration* before, CalibrationMap* map) {
  map->ignore({"cam_overlaps", "rostopic", "camera_model"});
  CameraCalibration camera;
  camera.name = fmt::format("cam{}", number);
  readCameraModel("distortion_coeffs", map, &camera);
  camera.body_from_camera = readBodyFromCamera(before, map);
  camera.time_offset_to_imu_s = map->numberOr("timeshift_cam_imu", 0.0);
  camera.rate_hz = 0.0;
  return camera;
}

KalibrImu readKalibrImu(CalibrationMap* map) {
  map->ignore({"rostopic"});
  KalibrImu imu;
  if (map->has("T_i_b")) imu.imu_from_kalibr_body = map->transform("T_i_b");
  imu.calibration.noise = readImuNoise(map);
  imu.calibration.rate_hz = map->numberOr("update_rate", 0.0);
  imu.correction = readImuCorrection(map);
  return imu;
}

}  // namespace lodeline

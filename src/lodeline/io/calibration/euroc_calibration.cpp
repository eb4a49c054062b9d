#include "lodeline/io/calibration/euroc_calibration.h"

#include <fmt/core.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/camera_keys.h"
#include "lodeline/io/calibration/imu_keys.h"
#include "lodeline/io/calibration/yaml_file.h"

namespace lodeline {
namespace {

double positive(const std::string& key, CalibrationMap* map) {
  const double value = map->number(key);
  if (!(value > 0.0)) throw InputError(fmt::format("{} is {:g}; it must be positive", map->at(key), value));
  return value;
}

double rateOrUnknown(CalibrationMap* map) { return map->has("rate_hz") ? positive("rate_hz", map) : 0.0; }

std::string maskOrNone(CalibrationMap* map) {
  if (!map->has("mask")) return {};
  const std::filesystem::path mask = map->file().parent_path() / map->text("mask");
  if (!std::filesystem::is_regular_file(mask)) {
    throw InputError(fmt::format("{} names {}, which does not exist", map->at("mask"), mask.string()));
  }
  return mask.string();
}

/// Reads a sensor with only extrinsics, rate and one noise value.
template <typename Calibration>
Calibration readSmallSensor(Rigid3 Calibration::*body_from_sensor, const std::string& noise_key,
                            double Calibration::*noise, CalibrationMap* map) {
  map->ignore({"sensor_type", "comment"});
  Calibration calibration;
  calibration.*body_from_sensor = map->transform("T_BS");
  calibration.rate_hz = rateOrUnknown(map);
  calibration.*noise = positive(noise_key, map);
  return calibration;
}

}  // namespace

EurocImu readEurocImu(CalibrationMap* map) {
  map->ignore({"sensor_type", "comment"});
  EurocImu imu;
  if (map->has("T_BS")) imu.euroc_body_from_imu = map->transform("T_BS");
  imu.calibration.rate_hz = rateOrUnknown(map);
  imu.calibration.noise = readImuNoise(map);
  imu.correction = readImuCorrection(map);
  return imu;
}

EurocCameraExtras readEurocCameraExtras(CalibrationMap* map) { return {rateOrUnknown(map), maskOrNone(map)}; }

CameraCalibration readEurocCamera(const std::string& name, CalibrationMap* map) {
  map->ignore({"sensor_type", "comment"});
  CameraCalibration camera;
  camera.name = name;
  readCameraModel("distortion_coefficients", map, &camera);
  if (!map->has("T_BS")) {
    throw InputError(
        fmt::format("{} (camera to IMU) is missing: this is the calibration of a camera alone. Calibrate "
                    "camera and IMU together (Kalibr), or add a rig file with "
                    "`{}: {{T_BS: …}}`",
                    map->at("T_BS"), name));
  }
  camera.body_from_camera = map->transform("T_BS");
  camera.rate_hz = rateOrUnknown(map);
  camera.time_offset_to_imu_s = map->numberOr("timeshift_cam_imu", 0.0);
  camera.mask_file = maskOrNone(map);
  return camera;
}

MagnetometerCalibration readEurocMagnetometer(CalibrationMap* map) {
  using Calibration = MagnetometerCalibration;
  return readSmallSensor(&Calibration::body_from_magnetometer, "magnetometer_noise_density",
                         &Calibration::noise_density_T_per_sqrtHz, map);
}

PressureCalibration readEurocPressure(CalibrationMap* map) {
  using Calibration = PressureCalibration;
  return readSmallSensor(&Calibration::body_from_pressure, "depth_noise_std", &Calibration::depth_noise_std_m,
                         map);
}

SonarCalibration readEurocSonar(CalibrationMap* map) {
  using Calibration = SonarCalibration;
  Calibration calibration =
      readSmallSensor(&Calibration::body_from_sonar, "range_noise_std", &Calibration::range_noise_std_m, map);
  if (map->has("beam_width")) calibration.beam_width_rad = positive("beam_width", map);
  if (map->has("max_range")) calibration.max_range_m = positive("max_range", map);
  return calibration;
}

}  // namespace lodeline

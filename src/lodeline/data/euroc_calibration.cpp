#include "lodeline/data/euroc_calibration.h"

#include <fmt/core.h>

#include "lodeline/base/error.h"
#include "lodeline/data/camera_keys.h"
#include "lodeline/data/imu_keys.h"
#include "lodeline/data/yaml_file.h"

namespace lodeline {
namespace {

CalibrationMap open(const std::filesystem::path& file) {
  CalibrationMap map(loadYamlFile(file), file, "");
  map.ignore({"sensor_type", "comment"});
  return map;
}

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

}  // namespace

EurocImu readEurocImu(const std::filesystem::path& file, Diagnostics* diagnostics) {
  CalibrationMap map = open(file);
  EurocImu imu;
  if (map.has("T_BS")) imu.euroc_body_from_imu = map.transform("T_BS");
  imu.calibration.rate_hz = rateOrUnknown(&map);
  imu.calibration.noise = readImuNoise(&map);
  map.reportUnknownKeys(diagnostics);
  return imu;
}

EurocCameraExtras readEurocCameraExtras(const std::filesystem::path& file) {
  CalibrationMap map = open(file);
  return {rateOrUnknown(&map), maskOrNone(&map)};
}

CameraCalibration readEurocCamera(const std::filesystem::path& file, const std::string& name,
                                  Diagnostics* diagnostics) {
  CalibrationMap map = open(file);
  CameraCalibration camera;
  camera.name = name;
  readPinhole("distortion_coefficients", &map, &camera);
  camera.body_from_camera = map.transform("T_BS");
  camera.rate_hz = rateOrUnknown(&map);
  camera.time_offset_to_imu_s = map.numberOr("timeshift_cam_imu", 0.0);
  camera.mask_file = maskOrNone(&map);
  map.reportUnknownKeys(diagnostics);
  return camera;
}

MagnetometerCalibration readEurocMagnetometer(const std::filesystem::path& file, Diagnostics* diagnostics) {
  CalibrationMap map = open(file);
  MagnetometerCalibration magnetometer;
  magnetometer.body_from_magnetometer = map.transform("T_BS");
  magnetometer.rate_hz = rateOrUnknown(&map);
  magnetometer.noise_density_T_per_sqrtHz = positive("magnetometer_noise_density", &map);
  map.reportUnknownKeys(diagnostics);
  return magnetometer;
}

PressureCalibration readEurocPressure(const std::filesystem::path& file, Diagnostics* diagnostics) {
  CalibrationMap map = open(file);
  PressureCalibration pressure;
  pressure.body_from_pressure = map.transform("T_BS");
  pressure.rate_hz = rateOrUnknown(&map);
  pressure.depth_noise_std_m = positive("depth_noise_std", &map);
  map.reportUnknownKeys(diagnostics);
  return pressure;
}

SonarCalibration readEurocSonar(const std::filesystem::path& file, Diagnostics* diagnostics) {
  CalibrationMap map = open(file);
  SonarCalibration sonar;
  sonar.body_from_sonar = map.transform("T_BS");
  sonar.rate_hz = rateOrUnknown(&map);
  sonar.range_noise_std_m = positive("range_noise_std", &map);
  map.reportUnknownKeys(diagnostics);
  return sonar;
}

}  // namespace lodeline

#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lodeline/base/diagnostics.h"
#include "lodeline/data/yaml_file.h"
#include "lodeline/sensors/rig.h"

namespace lodeline {

/// How a pressure becomes a depth: depth = (pressure - surface) / (density * 9.80665 m/s^2).
struct WaterColumn {
  double density_kg_per_m3 = 1000.0;
  double surface_pressure_Pa = 101325.0;

  double depth_m(double pressure_Pa) const;
  double pressure_Pa(double depth_m) const;
};

/// One sensor's section of a rig file.
struct RigSection {
  YAML::Node node;
  std::filesystem::path file;
  bool is_kalibr = false;  ///< in Kalibr's keys, else in those of EuRoC's sensor.yaml
};

/// What is known of a rig whose recording does not say it itself.
struct RigFile {
  /// In the IMU's frame. A rate that is not stated is 0.
  Rig rig;
  bool has_imu = false;
  /// Topics as far as they are named, by sensor: cam0, imu0, mag0, pressure0, sonar0.
  std::map<std::string, std::string> topics;
  WaterColumn water;
  std::map<std::string, RigSection> sections;
};

/// Reads one or several files that together describe a rig, one section a sensor:
///
///     cam0: {topic: /left/image_raw, T_BS: …, resolution: …, intrinsics: …, …}   cam1: …
///     imu0: {topic: /imu, gyroscope_noise_density: …, …}
///     mag0: {T_BS: …, magnetometer_noise_density: …}
///     pressure0: {T_BS: …, depth_noise_std: …, water_density_kg_per_m3: 1025, surface_pressure_Pa: 101325}
///     sonar0: {T_BS: …, range_noise_std: …}
///
/// with the keys of EuRoC's sensor.yaml, or Kalibr's (camchain-imucam.yaml and imu.yaml are such files as
/// they are, with `rostopic` for the topic). `topic` may be missing. Throws InputError for unknown keys,
/// naming the nearest known one (in Kalibr's sections they are reported instead), for a sensor that is
/// described twice, and for what is missing or wrong.
RigFile readRigFiles(const std::vector<std::filesystem::path>& files, Diagnostics* diagnostics);

/// Leaves only the cameras that are asked for, in that order; all where `indices` is empty. Throws
/// InputError, beginning with `name`, for a camera that the rig does not have.
void selectCameras(const std::vector<int>& indices, const std::string& name, Rig* rig);

}  // namespace lodeline

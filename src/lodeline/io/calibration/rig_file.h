#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "lodeline/io/calibration/rig_sections.h"
#include "lodeline/sensors/imu_correction.h"
#include "lodeline/sensors/rig.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// How a pressure becomes a depth: depth = (pressure - surface) / (density * 9.80665 m/s^2).
struct WaterColumn {
  double density_kg_per_m3 = 1000.0;
  double surface_pressure_Pa = 101325.0;

  double depth_m(double pressure_Pa) const;
  double pressure_Pa(double depth_m) const;
};

/// What is known of a rig whose recording does not say it itself.
struct RigFile {
  /// In the IMU's frame, cameras by their numbers. A rate that is not stated is 0.
  Rig rig;
  bool has_imu = false;
  /// What a recording's inertial readings are to be freed from; nothing where no file states it.
  std::optional<ImuCorrection> imu_correction;
  /// Topics as far as they are named, by sensor: cam0, imu0, mag0, pressure0, sonar0.
  std::map<std::string, std::string> topics;
  WaterColumn water;
  /// What it was read from, without the keys that nobody knows.
  RigSections sections;
  std::set<std::string> without_extrinsics;  ///< cameras; see RigRequirements
};

struct RigRequirements {
  /// False takes cameras of which no file says how they are mounted, in the IMU's place.
  bool needs_extrinsics = true;
  /// False allows for cameras that are left out (cam0, cam2).
  bool needs_all_cameras = true;
};

/// Reads one or several files that together describe a rig, one section a sensor:
///
///     cam0: {topic: /left/image_raw, T_BS: …, resolution: …, intrinsics: …, …}   cam1: …
///     imu0: {topic: /imu, gyroscope_noise_density: …, …}
///     mag0: {T_BS: …, magnetometer_noise_density: …}
///     pressure0: {T_BS: …, depth_noise_std: …, water_density_kg_per_m3: 1025, surface_pressure_Pa: 101325}
///     sonar0: {T_BS: …, range_noise_std: …}
///
/// with the keys of EuRoC's sensor.yaml, or those of Kalibr and OpenVINS, or the files of other programs (see
/// collectRigSections). `topic` may be missing. Throws InputError for unknown keys, naming the nearest known
/// one (in others' sections they are reported instead), for a key that is described twice, and for what is
/// missing or wrong.
RigFile readRigFiles(const std::vector<std::filesystem::path>& files, Diagnostics* diagnostics);

/// The same from sections. A correction of inertial readings is reported as `imu_correction`.
RigFile readRig(const RigSections& sections, const RigRequirements& requirements, Diagnostics* diagnostics);

/// Leaves only the cameras that are asked for, in that order; all where `indices` is empty. Throws
/// InputError, beginning with `name`, for a camera that the rig does not have.
void selectCameras(const std::vector<int>& indices, const std::string& name, Rig* rig);

}  // namespace lodeline

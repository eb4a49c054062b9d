#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/rig_sections.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Parameters that convert pressure to depth: depth = (pressure - surface) / (density * 9.80665 m/s^2).
struct WaterColumn {
  double density_kg_per_m3 = 1000.0;
  double surface_pressure_Pa = 101325.0;

  double depth_m(double pressure_Pa) const;
  double pressure_Pa(double depth_m) const;
};

/// Content of rig files: the description of a rig that its recording does not contain.
struct RigFile {
  /// Extrinsics are relative to the IMU frame; cameras are sorted by number. An unstated rate is 0.
  Rig rig;
  bool has_imu = false;
  /// Correction to apply to the recorded inertial readings; nothing where no file states it.
  std::optional<ImuCorrection> imu_correction;
  /// Topics given in the files, by sensor: cam0, imu0, mag0, dvl0, ….
  std::map<std::string, std::string> topics;
  WaterColumn water;
  /// The sections from which the rig was read, without unknown keys.
  RigSections sections;
  std::set<std::string> without_extrinsics;  ///< cameras; see RigRequirements
};

struct RigRequirements {
  /// False accepts cameras without extrinsics and places them at the IMU.
  bool needs_extrinsics = true;
  /// False accepts missing camera numbers (cam0, cam2).
  bool needs_all_cameras = true;
};

/// Reads one or several files that together describe a rig, with one section per sensor:
///
///     cam0: {topic: /left/image_raw, T_BS: …, resolution: …, intrinsics: …, …}
///     cam1: …
///     imu0: {topic: /imu, gyroscope_noise_density: …, …}
///     mag0: {T_BS: …, magnetometer_noise_density: …}
///     pressure0: {T_BS: …, depth_noise_std: …, water_density_kg_per_m3: 1025, surface_pressure_Pa: 101325}
///     sonar0, altimeter0: {T_BS: …, range_noise_std: …}, dvl0, current0: see readDvl(), readCurrents()
///
/// The keys are those of EuRoC's sensor.yaml or of Kalibr and OpenVINS; files of other programs are also
/// accepted (see collectRigSections). `topic` may be missing. Throws InputError for unknown keys, naming the
/// nearest known key, for a key described twice, and for missing or wrong values. Unknown keys in sections of
/// other programs are only reported.
RigFile readRigFiles(const std::vector<std::filesystem::path>& files, Diagnostics* diagnostics);

/// Reads a rig from sections. Reports a correction of inertial readings as `imu_correction`.
RigFile readRig(const RigSections& sections, const RigRequirements& requirements, Diagnostics* diagnostics);

/// Keeps only the requested cameras, in the order of `indices`; keeps all where `indices` is empty. Throws
/// InputError, beginning with `name`, for a camera that the rig does not have.
void selectCameras(const std::vector<int>& indices, const std::string& name, Rig* rig);

/// Path of NAME.rig.yaml for a recording in one file, as NAME.bag or NAME.mp4, or in a folder NAME.
std::filesystem::path rigFileBeside(const std::filesystem::path& recording);

/// The rig of a recording that does not hold one: from `rig_files`, or from the file beside the recording.
/// Without both, throws InputError, or returns an empty rig where no calibration is needed. `kind`: of the
/// recording, e.g. "a bag".
RigFile readRigOf(const std::filesystem::path& recording, const std::string& kind,
                  const std::vector<std::filesystem::path>& rig_files, bool needs_calibration,
                  Diagnostics* diagnostics);

}  // namespace lodeline

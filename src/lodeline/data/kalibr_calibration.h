#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "lodeline/base/diagnostics.h"
#include "lodeline/data/yaml_file.h"
#include "lodeline/sensors/rig.h"

namespace lodeline {

/// Kalibr's result files of one recording, as far as there are any.
struct KalibrFiles {
  std::optional<std::filesystem::path> camchain;  ///< camchain-imucam.yaml, or with a recording's name added
  std::optional<std::filesystem::path> imu;       ///< imu.yaml, imu0.yaml, or with a recording's name added
};

/// Looks through the folders in turn and takes the first that has such a file. Throws InputError where one
/// folder has several of a kind.
KalibrFiles findKalibrFiles(const std::vector<std::filesystem::path>& folders);

/// The cameras cam0, cam1, … of a camchain with `T_cam_imu` (or `T_cn_cnm1` from the one before) and
/// `timeshift_cam_imu`. The body frame is the IMU's. The rate, which Kalibr does not write, is returned as 0.
/// Throws InputError naming file and key.
std::vector<CameraCalibration> readKalibrCameras(const std::filesystem::path& file, Diagnostics* diagnostics);

/// Noise and `update_rate`, either at the top of the file or under `imu0`. Throws InputError naming file and
/// key.
ImuCalibration readKalibrImu(const std::filesystem::path& file, Diagnostics* diagnostics);

/// One camera of a camchain, after those `before` it in the chain; which keys of its map are unknown is left
/// to the caller.
CameraCalibration readKalibrCamera(const std::vector<CameraCalibration>& before, CalibrationMap* map);
ImuCalibration readKalibrImu(CalibrationMap* map);

}  // namespace lodeline

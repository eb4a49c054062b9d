#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/recording.h"
#include "lodeline/rig.h"

namespace lodeline {

struct RigFile;

/// Paths and parts of an EuRoC ASL recording.
struct EurocLayout {
  std::filesystem::path mav0;
  std::vector<int> camera_indices;  ///< N of the camN used, in the order of Rig::cameras
  /// Cameras with a folder but without usable images, and the reason.
  std::map<int, std::string> cameras_without_images = {};
  bool has_imu = false;
  bool needs_cameras = true, needs_calibration = true;  ///< as in EurocOptions
  std::vector<std::filesystem::path> rig_files = {};    ///< as in EurocOptions

  std::filesystem::path sensor(const std::string& name) const { return mav0 / name; }
  std::filesystem::path csv(const std::string& name) const { return mav0 / name / "data.csv"; }
};

/// Finds `mav0` (`data` itself or a folder in it) and its parts. Throws InputError where there is no
/// recording, or where a part that `options` require is missing: a camera, one of the named cameras, or the
/// IMU. Where neither is required, at least one camera, IMU or magnetometer must exist.
EurocLayout findEurocLayout(const std::filesystem::path& data, const EurocOptions& options);

/// Reads the calibration of every sensor that has a `data.csv` (for cameras: images that can be listed; see
/// readFolderCalibration). The body frame of the result is the IMU frame, even where EuRoC's body is another.
/// Rates that no file states, or that contradict the stamps, are measured. Optional sensors whose CSV has no
/// usable row are left out with a warning. Rig::imu keeps its defaults where the recording has no IMU. Throws
/// InputError naming file and key for a missing or incomplete calibration, and for a camera or IMU without
/// data.
Rig readEurocRig(const EurocLayout& layout, Diagnostics* diagnostics);

/// Completes the rig as readEurocRig() does, from a calibration that readFolderCalibration() has read.
Rig settleEurocRig(const EurocLayout& layout, const RigFile& described, Diagnostics* diagnostics);

}  // namespace lodeline

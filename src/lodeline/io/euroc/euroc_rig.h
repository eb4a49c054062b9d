#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lodeline/sensors/rig.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

struct RigFile;

/// What to read of an EuRoC ASL recording. The defaults are what estimating a trajectory takes; tools that
/// look at inertial or magnetic readings alone open recordings that have nothing else.
struct EurocOptions {
  /// N of the camN folders to use; the first one is the reference. Empty for all that the recording has.
  std::vector<int> camera_indices;
  /// False leaves cameras out, whether the recording has any or not.
  bool with_cameras = true;
  /// False uses the cameras that there are, be it none, or the bare lists of those whose images are missing.
  bool needs_cameras = true;
  /// False for a recording that may have no `imu0`; EuRoC's body is the body frame then.
  bool needs_imu = true;
  /// False gives sensors without a calibration file the default one, with a warning; a camera's has no size
  /// then and cannot project.
  bool needs_calibration = true;
  /// Files that describe the rig (see readRigFiles), before those that lie in the recording.
  std::vector<std::filesystem::path> rig_files = {};
};

/// Where the parts of an EuRoC ASL recording lie.
struct EurocLayout {
  std::filesystem::path mav0;
  std::vector<int> camera_indices;  ///< N of the camN used, in the order of Rig::cameras
  /// Cameras that have a folder but no images that can be used, and why.
  std::map<int, std::string> cameras_without_images = {};
  bool has_imu = false;
  bool needs_cameras = true, needs_calibration = true;  ///< as in EurocOptions
  std::vector<std::filesystem::path> rig_files = {};    ///< likewise

  std::filesystem::path sensor(const std::string& name) const { return mav0 / name; }
  std::filesystem::path csv(const std::string& name) const { return mav0 / name / "data.csv"; }
};

/// Finds `mav0` (given itself, or the folder that contains it) and what is in it. Throws InputError where
/// there is no recording, or nothing of what `options` ask for: no camera, not one of those named, no IMU,
/// or, with neither needed, no camera, IMU or magnetometer.
EurocLayout findEurocLayout(const std::filesystem::path& data, const EurocOptions& options);

/// Reads the calibration of every sensor that has a `data.csv` (a camera: images that can be listed; see
/// readFolderCalibration). The body frame of the result is the IMU frame, also where EuRoC's body is another.
/// Rates that no file states, or that contradict the stamps, are measured. Optional sensors whose CSV has no
/// usable row are left out with a warning. Rig::imu keeps its defaults where the recording has no IMU. Throws
/// InputError naming file and key for a calibration that is absent or incomplete, and for a camera or IMU
/// without data.
Rig readEurocRig(const EurocLayout& layout, Diagnostics* diagnostics);

/// The same from a calibration that readFolderCalibration() has read.
Rig settleEurocRig(const EurocLayout& layout, const RigFile& described, Diagnostics* diagnostics);

}  // namespace lodeline

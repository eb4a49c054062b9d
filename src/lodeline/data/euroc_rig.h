#pragma once

#include <filesystem>
#include <vector>

#include "lodeline/base/diagnostics.h"
#include "lodeline/sensors/rig.h"

namespace lodeline {

/// Where the parts of an EuRoC ASL recording lie.
struct EurocLayout {
  std::filesystem::path mav0;
  std::vector<int> camera_indices;  ///< N of the camN used, in the order of Rig::cameras

  std::filesystem::path sensor(const std::string& name) const { return mav0 / name; }
  std::filesystem::path csv(const std::string& name) const { return mav0 / name / "data.csv"; }
};

/// Finds `mav0` (given itself, or the folder that contains it) and its cameras; all of them, or those asked
/// for. Throws InputError where there is no recording, no camera, no IMU, or not a camera asked for.
EurocLayout findEurocLayout(const std::filesystem::path& data, const std::vector<int>& camera_indices);

/// Reads the calibration of every sensor that has a `data.csv`: Kalibr's files beside or in mav0 before the
/// sensor.yaml files, which is reported as a notice. The body frame of the result is the IMU frame, also
/// where EuRoC's body is another. Rates that no file states, or that contradict the stamps, are measured.
/// Optional sensors whose CSV has no usable row are left out with a warning. Throws InputError naming file
/// and key for a calibration that is absent or incomplete, and for a camera or IMU without data.
Rig readEurocRig(const EurocLayout& layout, Diagnostics* diagnostics);

}  // namespace lodeline

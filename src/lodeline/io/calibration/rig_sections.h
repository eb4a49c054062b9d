#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lodeline/io/calibration/yaml_file.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// In whose keys a sensor is described.
enum class SectionKeys {
  Rig,     ///< ours: an unknown key is an error
  Euroc,   ///< a sensor.yaml, the same keys: an unknown one is passed over with a notice
  Kalibr,  ///< Kalibr's and OpenVINS's: likewise
};

/// What a file says of one sensor.
struct RigSection {
  YAML::Node node;
  std::filesystem::path file;
  SectionKeys keys = SectionKeys::Rig;
  std::string prefix;  ///< the section's own key in the file; empty where the whole file is the section
};

/// By sensor: cam0, cam1, …, imu0, mag0, pressure0, sonar0.
using RigSections = std::map<std::string, RigSection>;

/// Collects what one or several files say of a rig's sensors. Whose calibrations they are is told by their
/// keys (see CalibrationKind); those of other programs come translated into our keys, which is reported as
/// `calibration_translated`. Files of a single camera get the number that their name has (cam1.yaml, left,
/// right), or that of their place among them, which is reported as `calibration_order`. Two files may
/// describe the same sensor where they name different keys. Throws InputError, naming file and line, for a
/// file of another kind, for an unknown sensor and for a key that is described twice.
RigSections collectRigSections(const std::vector<std::filesystem::path>& files, Diagnostics* diagnostics);

}  // namespace lodeline

#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/yaml_file.h"

namespace lodeline {

/// Set of keys that describes a sensor.
enum class SectionKeys {
  Rig,     ///< Lodeline's keys: an unknown key is an error
  Euroc,   ///< a sensor.yaml with the same keys: an unknown key is ignored with a notice
  Kalibr,  ///< Kalibr's and OpenVINS's keys: an unknown key is ignored with a notice
};

/// Description of one sensor in one file.
struct RigSection {
  YAML::Node node;
  std::filesystem::path file;
  SectionKeys keys = SectionKeys::Rig;
  std::string prefix;  ///< key of the section in the file; empty where the whole file is the section
};

/// Sections by sensor: cam0, cam1, …, imu0, mag0, pressure0, ….
using RigSections = std::map<std::string, RigSection>;

/// Collects the sensor descriptions of one or several files. The keys of a file determine its format (see
/// CalibrationKind). Files of other programs are translated to Lodeline's keys and reported as
/// `calibration_translated`. A single-camera file gets the number in its name (cam1.yaml, left, right).
/// Otherwise it gets the number of its position in the list, which is reported as `calibration_order`. Two
/// files may describe the same sensor with different keys. Throws InputError, naming file and line, for a
/// file of another kind, for an unknown sensor and for a key described twice.
RigSections collectRigSections(const std::vector<std::filesystem::path>& files, Diagnostics* diagnostics);

}  // namespace lodeline

#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/types.h"

namespace lodeline {

/// Parses a YAML or JSON file, including OpenCV's header (%YAML:1.0) and its `key:value`. Throws InputError
/// with file and line where the file is missing, is not text (the message names its kind) or is not valid
/// YAML.
YAML::Node loadYamlFile(const std::filesystem::path& file);

/// Whether a node is a map that has at least one of the keys.
bool hasAnyKey(const YAML::Node& node, std::initializer_list<const char*> keys);

/// One map of a sensor's calibration, with error messages that name the file and the key. It records the
/// requested keys so that the remaining ones can be reported.
class CalibrationMap {
 public:
  /// `section`: key of the map in the file, for messages; empty for the whole file. Throws InputError where
  /// `node` is not a map.
  CalibrationMap(const YAML::Node& node, std::filesystem::path file, std::string section);

  bool has(const std::string& key);
  /// Each function throws InputError where the key is missing or has another type.
  double number(const std::string& key);
  std::string text(const std::string& key);
  std::vector<double> numbers(const std::string& key);
  /// A 4x4 matrix: EuRoC's map of cols, rows, data, or 16 numbers, or 4 rows of 4.
  Rigid3 transform(const std::string& key);
  /// A 3x3 matrix, row by row.
  Mat3 matrix3(const std::string& key);
  Vec3 vector3(const std::string& key);
  double numberOr(const std::string& key, double fallback);
  /// The map under a key; nothing where the key is missing.
  std::optional<CalibrationMap> section(const std::string& key);

  /// Declares keys that are known but not used.
  void ignore(const std::vector<std::string>& keys);
  /// Reports every key that was neither requested nor ignored.
  void reportUnknownKeys(Diagnostics* diagnostics) const;
  /// The requested and ignored keys with their values.
  YAML::Node knownPart() const;
  /// For Lodeline's own files: throws InputError for an unknown key, naming its line and the nearest known
  /// key.
  void refuseUnknownKeys() const;

  /// "FILE: key KEY", for messages; "FILE:LINE: key KEY" where the key exists.
  std::string at(const std::string& key) const;
  std::string atLine(const std::string& key) const;
  const std::filesystem::path& file() const { return file_; }
  const YAML::Node& node() const { return node_; }

 private:
  YAML::Node require(const std::string& key);

  YAML::Node node_;
  std::filesystem::path file_;
  std::string section_;
  std::set<std::string> known_;
};

}  // namespace lodeline

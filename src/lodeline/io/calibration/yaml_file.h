#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "lodeline/geometry/rigid3.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// Parses a YAML or JSON file; the headers that OpenCV writes (%YAML:1.0) and its `key:value` are accepted.
/// Throws InputError, with file and line, where there is no such file, naming its kind where it is no text,
/// or where its text is no YAML.
YAML::Node loadYamlFile(const std::filesystem::path& file);

/// Whether a node is a map with one of the keys.
bool hasAnyKey(const YAML::Node& node, std::initializer_list<const char*> keys);

/// One map of a sensor's calibration, with errors that name the file and the key. Remembers which keys were
/// asked for, so that the others can be pointed out.
class CalibrationMap {
 public:
  /// `section`: the map's own key in the file, for messages; empty for the whole file. Throws InputError
  /// where `node` is not a map.
  CalibrationMap(YAML::Node node, std::filesystem::path file, std::string section);

  bool has(const std::string& key);
  /// Each throws InputError where the key is missing or holds something else.
  double number(const std::string& key);
  std::string text(const std::string& key);
  std::vector<double> numbers(const std::string& key);
  /// A 4x4 matrix as EuRoC's map of cols, rows, data, or as 16 numbers, or as 4 rows of 4.
  Rigid3 transform(const std::string& key);
  /// A 3x3 matrix, row by row.
  Mat3 matrix3(const std::string& key);
  Vec3 vector3(const std::string& key);
  double numberOr(const std::string& key, double fallback);
  /// The map under a key; nothing where there is no such key.
  std::optional<CalibrationMap> section(const std::string& key);

  /// Adds keys that are known but not needed.
  void ignore(const std::vector<std::string>& keys);
  /// Reports every key that was neither asked for nor ignored.
  void reportUnknownKeys(Diagnostics* diagnostics) const;
  /// The keys that were asked for or ignored, with their values.
  YAML::Node knownPart() const;
  /// For files of our own: throws InputError for such a key, naming its line and the nearest known one.
  void refuseUnknownKeys() const;

  /// "FILE: key KEY", for messages; "FILE:LINE: key KEY" where the key is there.
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

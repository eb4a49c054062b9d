#include "lodeline/io/calibration/yaml_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>

#include "lodeline/diagnostics.h"
#include "lodeline/io/tables/text_lines.h"
#include "lodeline/util/edit_distance.h"
#include "lodeline/util/files/file_kind.h"

namespace lodeline {
namespace {

std::vector<double> flatten(const YAML::Node& node) {
  std::vector<double> numbers;
  for (const YAML::Node& entry : node) {
    if (entry.IsSequence()) {
      for (const YAML::Node& inner : entry) numbers.push_back(inner.as<double>());
    } else {
      numbers.push_back(entry.as<double>());
    }
  }
  return numbers;
}

/// Inserts a blank after the colon: OpenCV accepts `key:value`, YAML does not.
std::string withBlankAfterKey(const std::string& line) {
  const size_t start = line.find_first_not_of(' ');
  const size_t colon = line.find(':');
  if (start == std::string::npos || colon == std::string::npos || colon + 1 >= line.size()) return line;
  const bool is_key = std::all_of(
      line.begin() + static_cast<std::ptrdiff_t>(start), line.begin() + static_cast<std::ptrdiff_t>(colon),
      [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '.'; });
  if (!is_key || std::isspace(static_cast<unsigned char>(line[colon + 1])) != 0) return line;
  return line.substr(0, colon + 1) + ' ' + line.substr(colon + 1);
}

}  // namespace

YAML::Node loadYamlFile(const std::filesystem::path& file) {
  const RecognizedFile recognized = recognizeFile(file);
  if (recognized.kind == FileKind::Missing) {
    throw InputError(fmt::format("{}: calibration file missing", file.string()));
  }
  if (!recognized.isText()) refuseFile(recognized, "a YAML file is needed here");
  TextLines lines(openFile(file), file.string());
  std::string text;
  bool is_opencv = false;
  for (std::string_view read; lines.next(&read);) {
    const std::string line(read);
    // OpenCV's directive lacks the blank that YAML requires. Directives are not needed; an empty line keeps
    // the line numbers of messages.
    const bool is_directive = line.starts_with('%');
    is_opencv = is_opencv || is_directive;
    text += (is_directive ? std::string() : is_opencv ? withBlankAfterKey(line) : line) + '\n';
  }
  try {
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw InputError(fmt::format("{}:{}: not valid YAML: {}", file.string(), error.mark.line + 1, error.msg));
  }
}

bool hasAnyKey(const YAML::Node& node, std::initializer_list<const char*> keys) {
  return node.IsMap() &&
         std::any_of(keys.begin(), keys.end(), [&](const char* key) { return node[key].IsDefined(); });
}

CalibrationMap::CalibrationMap(const YAML::Node& node, std::filesystem::path file, std::string section)
    : node_(node), file_(std::move(file)), section_(std::move(section)) {
  if (!node_.IsMap()) {
    throw InputError(fmt::format("{}: {} holds no keys; write the sensor's calibration there", file_.string(),
                                 section_.empty() ? "the file" : "'" + section_ + "'"));
  }
}

std::string CalibrationMap::at(const std::string& key) const {
  return fmt::format("{}: key '{}{}'", file_.string(), section_.empty() ? "" : section_ + ".", key);
}

std::string CalibrationMap::atLine(const std::string& key) const {
  const YAML::Node node = node_[key];
  if (!node.IsDefined()) return at(key);
  return fmt::format("{}:{}: key '{}{}'", file_.string(), node.Mark().line + 1,
                     section_.empty() ? "" : section_ + ".", key);
}

bool CalibrationMap::has(const std::string& key) {
  known_.insert(key);
  return node_[key].IsDefined() && !node_[key].IsNull();
}

YAML::Node CalibrationMap::require(const std::string& key) {
  if (!has(key)) throw InputError(at(key) + " is missing; the calibration is not complete without it");
  return node_[key];
}

double CalibrationMap::number(const std::string& key) {
  const YAML::Node node = require(key);
  try {
    return node.as<double>();
  } catch (const YAML::Exception&) {
    throw InputError(fmt::format("{} (line {}) is not a number", at(key), node.Mark().line + 1));
  }
}

double CalibrationMap::numberOr(const std::string& key, double fallback) {
  return has(key) ? number(key) : fallback;
}

std::string CalibrationMap::text(const std::string& key) {
  const YAML::Node node = require(key);
  if (!node.IsScalar()) {
    throw InputError(fmt::format("{} (line {}) is not a word", at(key), node.Mark().line + 1));
  }
  return node.Scalar();
}

std::vector<double> CalibrationMap::numbers(const std::string& key) {
  const YAML::Node node = require(key);
  try {
    if (node.IsSequence()) return flatten(node);
    if (node.IsMap() && node["data"].IsSequence()) return flatten(node["data"]);
  } catch (const YAML::Exception&) {
    // Reported below, together with nodes of another type.
  }
  throw InputError(fmt::format("{} (line {}) is not a list of numbers", at(key), node.Mark().line + 1));
}

Rigid3 CalibrationMap::transform(const std::string& key) {
  const std::vector<double> values = numbers(key);
  if (values.size() != 16) {
    throw InputError(fmt::format("{} has {} numbers where a 4x4 transform needs 16", at(key), values.size()));
  }
  const Eigen::Matrix4d matrix =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values.data());
  return Rigid3::fromMatrix(matrix, at(key).c_str());
}

Mat3 CalibrationMap::matrix3(const std::string& key) {
  const std::vector<double> values = numbers(key);
  if (values.size() != 9) {
    throw InputError(fmt::format("{} has {} numbers where a 3x3 matrix needs 9", atLine(key), values.size()));
  }
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(values.data());
}

Vec3 CalibrationMap::vector3(const std::string& key) {
  const std::vector<double> values = numbers(key);
  if (values.size() != 3) {
    throw InputError(fmt::format("{} has {} numbers where a vector needs 3", atLine(key), values.size()));
  }
  return Vec3(values.data());
}

std::optional<CalibrationMap> CalibrationMap::section(const std::string& key) {
  if (!has(key)) return std::nullopt;
  return CalibrationMap(node_[key], file_, section_.empty() ? key : section_ + "." + key);
}

void CalibrationMap::ignore(const std::vector<std::string>& keys) { known_.insert(keys.begin(), keys.end()); }

void CalibrationMap::reportUnknownKeys(Diagnostics* diagnostics) const {
  for (const auto& entry : node_) {
    const std::string key = entry.first.Scalar();
    if (known_.contains(key)) continue;
    diagnostics->report(
        Severity::Notice, "calibration_key",
        fmt::format("{} (line {}) is not known and passed over", at(key), entry.first.Mark().line + 1));
  }
}

YAML::Node CalibrationMap::knownPart() const {
  YAML::Node known(YAML::NodeType::Map);
  for (const auto& entry : node_) {
    if (known_.contains(entry.first.Scalar())) known[entry.first.Scalar()] = entry.second;
  }
  return known;
}

void CalibrationMap::refuseUnknownKeys() const {
  for (const auto& entry : node_) {
    const std::string key = entry.first.Scalar();
    if (known_.contains(key)) continue;
    const auto nearest = std::min_element(known_.begin(), known_.end(), [&](const auto& a, const auto& b) {
      return editDistance(key, a) < editDistance(key, b);
    });
    throw InputError(fmt::format("{}:{}: unknown key '{}{}'{}", file_.string(), entry.first.Mark().line + 1,
                                 section_.empty() ? "" : section_ + ".", key,
                                 nearest == known_.end() ? "" : "; did you mean '" + *nearest + "'?"));
  }
}

}  // namespace lodeline

#include "lodeline/data/yaml_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>

#include "lodeline/base/edit_distance.h"
#include "lodeline/base/error.h"

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

}  // namespace

YAML::Node loadYamlFile(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream || std::filesystem::is_directory(file)) {
    throw InputError(fmt::format("{}: calibration file missing", file.string()));
  }
  std::string text;
  for (std::string line; std::getline(stream, line);) {
    // OpenCV's directive lacks the blank that YAML asks for; directives say nothing we need. The empty line
    // keeps the line numbers of messages.
    text += (line.starts_with('%') ? std::string() : line) + '\n';
  }
  try {
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw InputError(fmt::format("{}:{}: not valid YAML: {}", file.string(), error.mark.line + 1, error.msg));
  }
}

CalibrationMap::CalibrationMap(YAML::Node node, std::filesystem::path file, std::string section)
    : node_(std::move(node)), file_(std::move(file)), section_(std::move(section)) {
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
    // Reported below, together with nodes of another shape.
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

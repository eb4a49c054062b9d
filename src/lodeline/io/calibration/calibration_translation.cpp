#include "lodeline/io/calibration/calibration_translation.h"

#include <fmt/core.h>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

void collectScalars(const YAML::Node& node, YAML::Node* list) {
  if (node.IsScalar()) {
    list->push_back(node.Scalar());
    return;
  }
  for (const YAML::Node& entry : node.IsMap() ? node["data"] : node) collectScalars(entry, list);
}

}  // namespace

void setCameraModel(const CameraModel& model, YAML::Node* camera) {
  (*camera)["camera_model"] = std::string(model.projections.front());
  (*camera)["distortion_model"] = std::string(model.distortions.front());
}

YAML::Node numbersAsWritten(const std::string& key, size_t count, CalibrationMap* map) {
  const std::vector<double> numbers = map->numbers(key);
  if (numbers.size() != count) {
    throw InputError(
        fmt::format("{} has {} numbers where {} are due", map->atLine(key), numbers.size(), count));
  }
  YAML::Node list(YAML::NodeType::Sequence);
  collectScalars(map->node()[key], &list);
  list.SetStyle(YAML::EmitterStyle::Flow);
  return list;
}

YAML::Node numbersUnder(const std::vector<std::string>& keys, CalibrationMap* map) {
  YAML::Node list(YAML::NodeType::Sequence);
  for (const std::string& key : keys) {
    map->number(key);
    list.push_back(map->text(key));
  }
  list.SetStyle(YAML::EmitterStyle::Flow);
  return list;
}

YAML::Node numberList(const std::vector<double>& numbers) {
  YAML::Node list(YAML::NodeType::Sequence);
  for (const double number : numbers) list.push_back(fmt::format("{}", number));
  list.SetStyle(YAML::EmitterStyle::Flow);
  return list;
}

YAML::Node transformNode(const Rigid3& transform) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = transform.matrix();
  return numberList({matrix.data(), matrix.data() + matrix.size()});
}

}  // namespace lodeline

#include "lodeline_ros/node_parameters.h"

#include <fmt/core.h>
#include <ros/param.h>

#include <algorithm>

#include "lodeline/diagnostics.h"
#include "lodeline/util/edit_distance.h"

namespace lodeline {
namespace {

/// A number of ROS's parameter server, whose integers have 32 bits.
bool get(const ros::NodeHandle& node, const std::string& name, int64_t* value) {
  int number = 0;
  if (!node.getParam(name, number)) return false;
  *value = number;
  return true;
}
bool get(const ros::NodeHandle& node, const std::string& name, bool* value) {
  return node.getParam(name, *value);
}
bool get(const ros::NodeHandle& node, const std::string& name, double* value) {
  return node.getParam(name, *value);
}
bool get(const ros::NodeHandle& node, const std::string& name, std::string* value) {
  return node.getParam(name, *value);
}
/// A text, a list of texts, or texts by name as NAME=TEXT.
bool get(const ros::NodeHandle& node, const std::string& name, std::vector<std::string>* value) {
  std::string one;
  if (node.getParam(name, one)) {
    *value = {one};
    return true;
  }
  std::map<std::string, std::string> by_name;
  if (node.getParam(name, by_name)) {
    for (const auto& [key, text] : by_name) value->push_back(fmt::format("{}={}", key, text));
    return true;
  }
  return node.getParam(name, *value);
}

/// Throws for the first parameter that is no option.
void refuseOthers(const ros::NodeHandle& node, const std::vector<std::string>& known) {
  const std::string prefix = node.getNamespace() + "/";
  std::vector<std::string> names;
  ros::param::getParamNames(names);
  for (const std::string& name : names) {
    if (!name.starts_with(prefix)) continue;
    std::string own = name.substr(prefix.size());
    own.erase(std::min(own.find('/'), own.size()));
    if (std::find(known.begin(), known.end(), own) != known.end()) continue;
    const auto nearest = std::min_element(known.begin(), known.end(), [&](const auto& a, const auto& b) {
      return editDistance(own, a) < editDistance(own, b);
    });
    throw UsageError(
        fmt::format("~{}: unknown parameter; did you mean ~{}? (The master keeps parameters of older runs: "
                    "rosparam delete {})",
                    own, *nearest, prefix + own));
  }
}

}  // namespace

OptionValues readNodeParameters(const ros::NodeHandle& node) {
  OptionValues values;
  std::vector<std::string> known;
  for (const NodeOption& option : nodeOptions()) {
    if (option.is_of_ros2) continue;
    known.push_back(option.name);
    if (!node.hasParam(option.name)) continue;
    std::visit(
        [&](auto value) {
          value = {};
          if (!get(node, option.name, &value)) {
            throw UsageError(fmt::format(
                "~{}: has a value of the wrong type (see docs/reference/ros-node.md)", option.name));
          }
          values[option.name] = value;
        },
        option.initial);
  }
  refuseOthers(node, known);
  return values;
}

}  // namespace lodeline

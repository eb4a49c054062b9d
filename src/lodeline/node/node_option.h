#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <variant>
#include <vector>

namespace lodeline {

/// Value of an option: the same types that parameters of ROS have.
using OptionValue = std::variant<bool, int64_t, double, std::string, std::vector<std::string>>;

/// Values by name.
using OptionValues = std::map<std::string, OptionValue>;

/// An option of a run on live topics: a parameter of a node, or an option of the command line.
struct NodeOption {
  std::string name;
  std::string meaning;
  OptionValue initial;
  /// Whether it concerns the quality of service, which ROS 1 does not have.
  bool is_of_ros2 = false;
};

/// All options. Values of another type than `initial` are errors. `topics` and `qos` are lists of
/// SENSOR=VALUE.
std::vector<NodeOption> nodeOptions();

}  // namespace lodeline

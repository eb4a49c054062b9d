#include "lodeline_ros2/parameters.h"

#include <rcl_interfaces/msg/parameter_descriptor.hpp>
#include <stdexcept>

namespace lodeline {
namespace {

OptionValue optionValue(const std::string& name, const rclcpp::ParameterValue& value) {
  switch (value.get_type()) {
    case rclcpp::ParameterType::PARAMETER_BOOL:
      return value.get<bool>();
    case rclcpp::ParameterType::PARAMETER_INTEGER:
      return value.get<int64_t>();
    case rclcpp::ParameterType::PARAMETER_DOUBLE:
      return value.get<double>();
    case rclcpp::ParameterType::PARAMETER_STRING:
      return value.get<std::string>();
    case rclcpp::ParameterType::PARAMETER_STRING_ARRAY:
      return value.get<std::vector<std::string>>();
    default:
      throw std::runtime_error(name + ": no option has a parameter of this type");
  }
}

rclcpp::ParameterValue parameterValue(const OptionValue& value) {
  return std::visit([](const auto& typed) { return rclcpp::ParameterValue(typed); }, value);
}

/// "SENSOR=VALUE" for each parameter "NAME.SENSOR" that was given.
std::vector<std::string> givenBySensor(const std::string& name, rclcpp::Node* node) {
  std::vector<std::string> list;
  const std::string prefix = name + ".";
  for (const auto& [full, value] : node->get_node_parameters_interface()->get_parameter_overrides()) {
    if (full.compare(0, prefix.size(), prefix) != 0) continue;
    node->declare_parameter(full, value);
    list.push_back(full.substr(prefix.size()) + "=" + value.get<std::string>());
  }
  return list;
}

}  // namespace

OptionValues readParameters(rclcpp::Node* node) {
  OptionValues values;
  for (const NodeOption& option : nodeOptions()) {
    rcl_interfaces::msg::ParameterDescriptor descriptor;
    descriptor.description = option.meaning;
    descriptor.read_only = true;
    descriptor.dynamic_typing =
        true;  // the session checks types: a list may be a single text, a number an integer
    const rclcpp::ParameterValue& value =
        node->declare_parameter(option.name, parameterValue(option.initial), descriptor);
    values[option.name] = optionValue(option.name, value);
    if (auto* list = std::get_if<std::vector<std::string>>(&values[option.name])) {
      for (const std::string& one : givenBySensor(option.name, node)) list->push_back(one);
    }
  }
  for (const auto& [name, value] : node->get_node_parameters_interface()->get_parameter_overrides()) {
    if (node->has_parameter(name) || name.rfind("qos_overrides.", 0) == 0) continue;
    values[name] = optionValue(name, value);
  }
  return values;
}

}  // namespace lodeline

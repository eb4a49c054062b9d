#include "apps/lodeline_dds/dds_options.h"

#include <fmt/core.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>

#include "apps/lodeline_dds/transport/dds_names.h"
#include "lodeline/diagnostics.h"
#include "lodeline/version.h"

namespace lodeline::dds {
namespace {

/// "--mag-calibration" for "mag_calibration".
std::string flagOf(const std::string& name) {
  std::string flag = "--" + name;
  std::replace(flag.begin(), flag.end(), '_', '-');
  return flag;
}

/// Adds an option whose value stays in `value`.
void add(const NodeOption& option, OptionValue* value, CLI::App* program) {
  const std::string flag = flagOf(option.name);
  std::visit(
      [&](auto& typed) {
        using Value = std::decay_t<decltype(typed)>;
        if constexpr (std::is_same_v<Value, bool>) {
          const std::string other = "--no-" + flag.substr(2);
          program->add_flag(fmt::format("{},!{}", flag, other), typed,
                            fmt::format("{}; {} is the opposite", option.meaning, other));
        } else if constexpr (std::is_same_v<Value, std::vector<std::string>>) {
          program->add_option(flag, typed, option.meaning);
        } else {
          program->add_option(flag, typed, option.meaning)->capture_default_str();
        }
      },
      *value);
}

}  // namespace

std::optional<Options> readOptions(int argc, char** argv) {
  CLI::App program(
      "The estimator on live topics of ROS 2, over DDS and without ROS 2: what a node of ROS 2 would do");
  program.name("lodeline_dds");
  program.set_version_flag("--version", fmt::format("lodeline_dds {}", LODELINE_VERSION));
  Options options;
  for (const NodeOption& option : nodeOptions()) options.session[option.name] = option.initial;
  for (const NodeOption& option : nodeOptions()) add(option, &options.session.at(option.name), &program);
  int64_t domain = 0;
  const CLI::Option* named_domain =
      program.add_option("--domain", domain, "domain of ROS 2; by default that of ROS_DOMAIN_ID, or 0");
  program.add_option("--namespace", options.name_space, "namespace of the results")->capture_default_str();
  program.add_flag("--all-interfaces", options.network.all_interfaces,
                   "reach other machines; without it, all sockets are those of this machine alone");
  program.footer(
      "Examples:\n"
      "  lodeline_dds --rig rig.yaml --output result\n"
      "  lodeline_dds --rig rig.yaml --topics cam0=/camera/left/image_raw imu0=/imu/data\n"
      "  lodeline_dds --rig rig.yaml --domain 7 --all-interfaces --qos imu0=reliable\n"
      "Ctrl-C ends the run and completes the files. docs/reference/ros2-node.md lists topics and frames.");
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) throw UsageError(error.what());
    program.exit(error);
    return std::nullopt;
  }
  if (named_domain->empty()) domain = domainOfEnvironment();
  checkDomain(domain, "--domain");
  options.network.domain = static_cast<int>(domain);
  fullName("topic", options.name_space);  // complains of a bad namespace
  return options;
}

}  // namespace lodeline::dds

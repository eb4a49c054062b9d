#include "apps/lodeline/program/settings_command.h"

#include <fmt/core.h>

#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "lodeline/pipeline/run_recording.h"

namespace lodeline {
namespace {

struct SettingsArguments {
  RunRequest request;
  bool with_expert = false;
};

void printSettings(const SettingsArguments& arguments) {
  Settings settings;
  RunSettings options;
  applyRequest(arguments.request, &settings, &options);
  std::ostringstream text;
  settings.write(text);
  std::string shown = text.str();
  // The expert tier is the last section.
  const size_t expert = shown.find("\nexpert:");
  if (!arguments.with_expert && expert != std::string::npos) shown.erase(expert + 1);
  fmt::print("{}", shown);
}

}  // namespace

void addSettingsCommand(CLI::App& program) {
  const auto arguments = std::make_shared<SettingsArguments>();
  CLI::App* command =
      program.add_subcommand("settings", "Print the settings of a run, with their meaning and value");
  command->add_flag("--expert", arguments->with_expert, "also those that few users need");
  command->add_option("-c,--config", arguments->request.config, "with the values of this file")
      ->type_name("FILE");
  command->add_option("-s,--set", arguments->request.overrides, "with this value; goes over the file")
      ->type_name("KEY=VALUE");
  command->footer(
      "The output is a configuration for `lodeline run --config`.\n"
      "Examples:\n"
      "  lodeline settings\n"
      "  lodeline settings --expert > all.yaml");
  command->callback([arguments] { printSettings(*arguments); });
}

}  // namespace lodeline

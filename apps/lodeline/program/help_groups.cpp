#include "apps/lodeline/program/help_groups.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace lodeline {
namespace {

using Groups = std::vector<std::pair<const char*, std::vector<std::string>>>;

const Groups& commandGroups() {
  static const Groups groups = {
      {"From a recording to a trajectory", {"run", "refine", "attitude", "batch"}},
      {"Recordings and rigs",
       {"inspect", "convert", "calibrate", "allan", "convert-calibration", "rig-template"}},
      {"Maps and surveys", {"export", "map", "survey", "walls", "report"}},
      {"Judging results", {"evaluate", "compare", "benchmark", "simulate"}},
      {"The program", {"settings", "completion", "manual"}}};
  return groups;
}

const Groups& optionGroups() {
  static const Groups groups = {
      {"Recording", {"rig", "topic", "received-times", "recording", "from", "to", "cameras"}},
      {"Place and time", {"site", "date", "entrance", "entrance-sigma", "crs", "vertical-datum"}},
      {"Settings", {"config", "set", "mag-calibration", "magnetometer", "map"}},
      {"Results", {"output", "overwrite", "json", "plots", "no-report", "draw-tracks", "pdf"}},
      {"Screen", {"live", "live-address", "live-wait", "rate", "verbose", "quiet", "help"}}};
  return groups;
}

/// Placeholders for the values of options in help texts, by the name of the option.
const std::map<std::string, const char*>& valueNames() {
  static const std::map<std::string, const char*> names = {
      {"output", "PATH"},   {"json", "FILE"}, {"plots", "FOLDER"},         {"config", "FILE"},
      {"set", "KEY=VALUE"}, {"map", "FILE"},  {"mag-calibration", "FILE"}, {"recording", "PATH"},
      {"board", "FILE"},    {"old", "FILE"},  {"compare", "FILE"}};
  return names;
}

/// Title of the group that contains `name`; null where none does.
const char* groupOf(const std::string& name, const Groups& groups) {
  for (const auto& [title, names] : groups) {
    if (std::find(names.begin(), names.end(), name) != names.end()) return title;
  }
  return nullptr;
}

void groupOptions(CLI::App* command) {
  command->get_help_ptr()->description("print this help");
  for (CLI::Option* option : command->get_options()) {
    if (option->get_positional() || option->get_lnames().empty()) continue;
    const std::string& name = option->get_lnames().front();
    if (const char* title = groupOf(name, optionGroups())) option->group(title);
    const auto value = valueNames().find(name);
    if (value != valueNames().end() && option->get_type_name() == "TEXT") option->type_name(value->second);
  }
  for (CLI::App* inner : command->get_subcommands([](CLI::App*) { return true; })) groupOptions(inner);
}

}  // namespace

void makeHelpGroups(CLI::App& program) {
  program.get_help_ptr()->description("print this help");
  for (CLI::App* command : program.get_subcommands([](CLI::App*) { return true; })) {
    if (const char* title = groupOf(command->get_name(), commandGroups())) command->group(title);
    groupOptions(command);
  }
}

std::vector<std::string> optionGroupTitles() {
  std::vector<std::string> titles;
  for (const auto& [title, names] : optionGroups()) titles.emplace_back(title);
  return titles;
}

}  // namespace lodeline

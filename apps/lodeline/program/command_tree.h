#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <string>
#include <vector>

namespace lodeline {

/// A command without further commands below it, such as `calibrate magnetometer`.
struct LeafCommand {
  std::vector<std::string> words;  ///< "calibrate", "magnetometer"
  const CLI::App* command = nullptr;
};

/// All of them, in the order of the help text.
std::vector<LeafCommand> leafCommands(const CLI::App& program);

/// Names of the options of a command, with dashes: "-o", "--output".
std::vector<std::string> optionNames(const CLI::App& command);

}  // namespace lodeline

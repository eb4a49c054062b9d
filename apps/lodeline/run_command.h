#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "apps/lodeline/shared/run_arguments.h"

namespace lodeline {

/// Adds the common options of `lodeline run` and `lodeline refine`: recording, output folder and settings.
/// `arguments` must outlive the command.
void addRunOptions(RunArguments* arguments, CLI::App* command);

/// Runs, prints the summary and writes the report. Throws InputError, UsageError and EstimationError.
void executeRun(RunRequest request);

/// `lodeline run DATA -o OUT`: from a recording to a trajectory, its uncertainty and a map. Its callback
/// throws InputError, UsageError, EstimationError and Interruption.
void addRunCommand(CLI::App& program);

/// The command line with `--live` as `--live=PORT`, whether a number follows or not. An option with an
/// optional value would take the next word as its value, for example the recording in `run --live dive1`.
std::vector<std::string> completeLiveOption(std::vector<std::string> arguments);

}  // namespace lodeline

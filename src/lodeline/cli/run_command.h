#pragma once

#include <CLI/App.hpp>

#include "lodeline/cli/run_request.h"

namespace lodeline {

/// What `lodeline run` and `lodeline refine` have in common: recording, output folder and settings.
/// `arguments` must outlive the command.
void addRunOptions(RunRequest* arguments, CLI::App* command);

/// Runs, prints the summary and writes the report. Throws InputError, UsageError and EstimationError.
void executeRun(RunRequest request);

/// `lodeline run DATA -o OUT`: from a recording to a trajectory, its uncertainty and a map. Its callback
/// throws InputError, UsageError and EstimationError.
void addRunCommand(CLI::App& program);

}  // namespace lodeline

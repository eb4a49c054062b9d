#pragma once

#include <CLI/App.hpp>
#include <string>

#include "lodeline/pipeline/run_recording.h"

namespace lodeline {

/// `lodeline report`: one page from the output folders of runs.
void addReportCommand(CLI::App& program);

/// Writes report.html of a finished run, compared with the ground truth that its recording brings along.
/// Returns a remark for the user, why the page or the comparison is missing; empty where all went well.
/// Throws InputError where the file cannot be written.
std::string writeRunReport(const RunRequest& request);

}  // namespace lodeline

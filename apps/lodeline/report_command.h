#pragma once

#include <CLI/App.hpp>
#include <string>

#include "lodeline/pipeline/run_recording.h"

namespace lodeline {

/// `lodeline report`: one page from the output folders of runs.
void addReportCommand(CLI::App& program);

/// Writes report.html of a finished run, compared with the ground truth of its recording, if there is one.
/// Returns a remark for the user with the reason if the page or the comparison is missing; empty otherwise.
/// Throws InputError where the file cannot be written.
std::string writeRunReport(const RunRequest& request);

}  // namespace lodeline

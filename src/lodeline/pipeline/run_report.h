#pragma once

#include <string>

#include "lodeline/pipeline/run_request.h"

namespace lodeline {

/// Writes report.html of a finished run, compared with the ground truth that its recording brings along.
/// Returns a remark for the user, why the page or the comparison is missing; empty where all went well.
/// Throws InputError where the file cannot be written.
std::string writeRunReport(const RunRequest& request);

}  // namespace lodeline

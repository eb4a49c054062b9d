#pragma once

#include <filesystem>

#include "lodeline/evaluation/errors/claims.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// What a run folder says of its errors: `states.csv`, and the heading's reference from `run.json`. No poses
/// where it has none of the first. Throws InputError where either cannot be understood.
ReportedUncertainty readReportedUncertainty(const std::filesystem::path& run_folder,
                                            Diagnostics* diagnostics);

}  // namespace lodeline

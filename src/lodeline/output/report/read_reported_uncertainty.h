#pragma once

#include <filesystem>

#include "lodeline/diagnostics.h"
#include "lodeline/trajectory.h"

namespace lodeline {

/// Reads the reported uncertainty of a run folder: `states.csv`, and the heading's reference from `run.json`.
/// There are no poses where `states.csv` is missing. Throws InputError where either is malformed.
ReportedUncertainty readReportedUncertainty(const std::filesystem::path& run_folder,
                                            Diagnostics* diagnostics);

}  // namespace lodeline

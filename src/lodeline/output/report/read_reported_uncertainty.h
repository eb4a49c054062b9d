#pragma once

#include <filesystem>

#include "lodeline/diagnostics.h"
#include "lodeline/trajectory.h"

namespace lodeline {

/// Reads the reported uncertainty of a run folder: `states.csv`, and the heading's reference from `run.json`.
/// There are no poses where `states.csv` is missing. Throws InputError where either is malformed.
ReportedUncertainty readReportedUncertainty(const std::filesystem::path& run_folder,
                                            Diagnostics* diagnostics);

/// Consistency of a run's reported sigmas with a reference. Where the files beside its trajectory are of
/// another version or damaged, there are no poses, and the finding `claims_unknown` says why.
ConsistencyCheck checkReported(const std::filesystem::path& run_folder, const Trajectory& reference,
                               const AssociationOptions& association, Diagnostics* diagnostics);

}  // namespace lodeline

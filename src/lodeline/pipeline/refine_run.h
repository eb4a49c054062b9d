#pragma once

#include <filesystem>
#include <map>

#include "lodeline/batch/refine.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// Solves a finished run as a whole and writes trajectory_refined.tum, states_refined.csv and
/// landmarks_refined.ply beside the run's own files; nothing, but a finding, where the solution is refused.
/// `result_stamps`: of frames whose results have another stamp than their time. Throws InputError where
/// writing fails.
RefinementSummary refineRun(const Estimator& estimator, const EstimatorLog& record,
                            const std::filesystem::path& folder, const std::map<Time, Time>& result_stamps,
                            Diagnostics* diagnostics);

/// What a refined run left in the folder would otherwise stand for the run that overwrites it.
void removeRefinedFiles(const std::filesystem::path& folder);

}  // namespace lodeline

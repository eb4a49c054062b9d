#pragma once

#include <filesystem>
#include <map>

#include "lodeline/batch/refine.h"
#include "lodeline/diagnostics.h"

namespace lodeline {

/// Computes the batch solution of a finished run and writes trajectory_refined.tum, states_refined.csv and
/// landmarks_refined.ply beside the run's own files; only a finding where the solution is rejected.
/// `result_stamps`: of frames whose results have a stamp other than their time. Throws InputError where
/// writing fails. `quiet`: show no progress.
RefinementSummary refineRun(const Estimator& estimator, const EstimatorLog& record, const LoopClosures& loops,
                            const std::filesystem::path& folder, const std::map<Time, Time>& result_stamps,
                            bool quiet, Diagnostics* diagnostics);

/// Removes the refined files of an earlier run in the folder, which would not belong to the new run.
void removeRefinedFiles(const std::filesystem::path& folder);

}  // namespace lodeline

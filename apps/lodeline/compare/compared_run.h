#pragma once

#include <string>
#include <vector>

#include "apps/lodeline/batch/batch_folder.h"
#include "apps/lodeline/batch/batch_summary.h"
#include "apps/lodeline/compare/comparison_input.h"
#include "lodeline/evaluation/errors/comparison.h"

namespace lodeline {

/// Whether `name` is a method of `lodeline compare`. "off", "paper" and "absolute" are models of the
/// magnetometer in the window. "azimuth" is the finished "off" trajectory corrected by
/// correctHeadingByAzimuth().
bool isComparedMethod(const std::string& name);

/// The runs that the methods need, as a batch: inputs × models × seeds.
BatchList comparedRuns(const std::vector<ComparisonInput>& inputs, const std::vector<std::string>& methods);

/// Evaluates one run of a method with the recording's ground truth. `rows` are those of the finished batch.
/// "azimuth" writes its trajectory beside the results of the batch. The reason for a run without errors is in
/// `failure`.
ComparedRun judgeComparedRun(const ComparisonInput& input, const ComparisonSeed& seed,
                             const std::string& method, const std::vector<BatchRow>& rows,
                             const BatchFolder& folder);

}  // namespace lodeline

#pragma once

#include "lodeline/diagnostics.h"
#include "lodeline/output/report/run_summary.h"
#include "lodeline/pipeline/run_request.h"

namespace lodeline {

/// Throws the error that explains a run without a result, or with one that is not to be trusted: InputError
/// without usable images, otherwise EstimationError. Does nothing after a good run.
void requireResult(const RunRequest& request, const RunSummary& summary, const Diagnostics& diagnostics);

}  // namespace lodeline

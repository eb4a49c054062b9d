#pragma once

#include "lodeline/output/report/run_summary.h"
#include "lodeline/pipeline/run_request.h"
#include "lodeline/pipeline/run_settings.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// Puts what the request says over the defaults. `settings` keeps pointing to `options`. Throws UsageError.
void applyRequest(const RunRequest& request, Settings* settings, RunSettings* options);

/// Runs the estimator over a recording and writes the folder of results (see README): trajectory, states,
/// landmarks and settings as it goes, run.json at the end, whether the recording or the user ended it.
/// Throws InputError and UsageError; a run that finds no pose returns its summary as any other.
RunSummary runRecording(const RunRequest& request, Diagnostics* diagnostics);

}  // namespace lodeline

#pragma once

#include "lodeline/api/run_settings.h"
#include "lodeline/diagnostics.h"
#include "lodeline/output/report/run_summary.h"
#include "lodeline/pipeline/run_request.h"

namespace lodeline {

/// Applies the request to the default settings. `settings` remains bound to `options`. Throws UsageError.
void applyRequest(const RunRequest& request, Settings* settings, RunSettings* options);

/// Runs the estimator over a recording and writes the output folder (see README): trajectory, states,
/// landmarks and settings during the run, run.json at the end, whether the recording or the user ended it.
/// Throws InputError and UsageError; a run without any pose also returns its summary.
RunSummary runRecording(const RunRequest& request, Diagnostics* diagnostics);

}  // namespace lodeline

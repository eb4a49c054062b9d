#pragma once

#include <memory>
#include <optional>

#include "lodeline/api/run_settings.h"
#include "lodeline/diagnostics.h"
#include "lodeline/output/report/run_summary.h"
#include "lodeline/pipeline/run_request.h"
#include "lodeline/pipeline/run_session.h"
#include "lodeline/recording.h"
#include "lodeline/util/settings/settings.h"

namespace lodeline {

/// Applies the request to the default settings. `settings` remains bound to `options`. Throws UsageError.
void applyRequest(const RunRequest& request, Settings* settings, RunSettings* options);

/// A run over a recording that the caller advances packet by packet:
///
///     RecordingRun run(request, &diagnostics);
///     while (run.session().fetch()) run.session().process();
///     const RunSummary summary = run.session().finish();
///
/// OpenCV then uses one thread in the whole process, and glibc keeps freed memory.
class RecordingRun {
 public:
  /// Opens the recording, checks its first seconds and makes the output folder. `diagnostics` must outlive
  /// the run. Throws InputError and UsageError.
  RecordingRun(const RunRequest& request, Diagnostics* diagnostics);
  RecordingRun(const RecordingRun&) = delete;
  RecordingRun& operator=(const RecordingRun&) = delete;

  RunSession& session() { return *session_; }
  const Rig& rig() const { return source_->rig(); }
  /// Share of the recording that was read, see RecordedSource.
  std::optional<double> shareRead() const { return source_->shareRead(); }
  /// Length of the part that the run reads; 0 for all.
  double length_s() const { return options_.synchronizer.duration_s; }

 private:
  RunSettings options_;
  Settings settings_;  ///< bound to the options
  std::unique_ptr<RecordedSource> source_;
  std::optional<RunSession> session_;
};

/// Runs the estimator over a recording and writes the output folder (see README): trajectory, states,
/// landmarks and settings during the run, run.json at the end, whether the recording or the user ended it.
/// Throws InputError and UsageError; a run without any pose also returns its summary.
RunSummary runRecording(const RunRequest& request, Diagnostics* diagnostics);

}  // namespace lodeline

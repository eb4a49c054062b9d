#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/base/diagnostics.h"
#include "lodeline/cli/open_recording.h"
#include "lodeline/cli/run_settings.h"
#include "lodeline/report/run_summary.h"

namespace lodeline {

/// One run of the estimator, in the words of the command line.
struct RunRequest {
  std::string data;                    ///< recording
  BagArguments bag;                    ///< where the recording is a bag
  std::string output;                  ///< folder for the results; made where it is missing
  std::string config;                  ///< file of settings; empty for none
  std::vector<std::string> overrides;  ///< KEY=VALUE, over the configuration
  std::optional<double> draw_tracks_s;
  std::string magnetometer_calibration;  ///< file; empty for what the configuration says
  std::string magnetometer;      ///< setting magnetometer.model; empty for what the configuration says
  std::string site;              ///< LAT,LON,HEIGHT (degrees, m); empty likewise
  std::string date;              ///< YYYY-MM-DD; empty likewise
  bool sample_pictures = false;  ///< keep pictures for report.html
  std::optional<int> live_port;  ///< show the run in the browser; 0 for any port
  std::string live_address = "127.0.0.1";  ///< from where that can be seen
  bool quiet = false;                      ///< no progress
};

/// Puts what the request says over the defaults. `settings` keeps pointing to `options`. Throws UsageError.
void applyRequest(const RunRequest& request, Settings* settings, RunSettings* options);

/// Runs the estimator over a recording and writes the folder of results (see README): trajectory, states,
/// landmarks and settings as it goes, run.json at the end, whether the recording or the user ended it.
/// Throws InputError and UsageError; a run that finds no pose returns its summary as any other.
RunSummary runRecording(const RunRequest& request, Diagnostics* diagnostics);

}  // namespace lodeline

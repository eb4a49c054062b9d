#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/pipeline/open_recording.h"

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
  bool no_report = false;        ///< leave out report.html
  bool sample_pictures = false;  ///< keep pictures for report.html
  std::optional<int> live_port;  ///< show the run in the browser; 0 for any port
  std::string live_address = "127.0.0.1";  ///< from where that can be seen
  bool quiet = false;                      ///< no progress
  bool verbose = false;                    ///< a summary with all figures
  bool overwrite = false;                  ///< replace the results of another run in the folder
  /// Solve for the whole recording afterwards, with states so far apart (`lodeline refine`).
  std::optional<double> refine_interval_s;
};

}  // namespace lodeline

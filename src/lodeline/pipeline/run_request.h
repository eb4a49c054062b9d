#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/mapping/session/dive_start.h"
#include "lodeline/pipeline/open_recording.h"

namespace lodeline {

/// One run of the estimator with the options of the command line.
struct RunRequest {
  std::string data;                    ///< recording
  BagArguments bag;                    ///< if the recording is a bag
  std::string output;                  ///< output folder; created if missing
  std::string config;                  ///< settings file; empty for none
  std::vector<std::string> overrides;  ///< KEY=VALUE, with priority over the configuration
  std::optional<double> draw_tracks_s;
  std::string magnetometer_calibration;  ///< file; empty for that of the configuration
  std::string magnetometer;              ///< setting magnetometer.model; empty for that of the configuration
  std::string site;                      ///< LAT,LON,HEIGHT (degrees, m); empty for that of the configuration
  std::string date;                      ///< YYYY-MM-DD; empty for that of the configuration
  bool no_report = false;                ///< no report.html
  bool sample_pictures = false;          ///< write pictures for report.html
  std::optional<int> live_port;          ///< show the run in the browser; 0 for any port
  std::string live_address = "127.0.0.1";  ///< address to which the live view is bound
  bool live_wait = false;                  ///< begin when a browser shows the live view
  std::optional<double> rate;              ///< at most so many times real time; empty for no bound
  bool quiet = false;                      ///< no progress
  bool verbose = false;                    ///< a summary with all values
  bool overwrite = false;                  ///< replace the results of another run in the folder
  std::string map;                         ///< map file in which the run looks for places; empty for none
  std::optional<DiveStart> map_start;      ///< where the dive began in that map, if known
  /// Computes the batch solution after the run, with states at most this far apart (`lodeline refine`).
  std::optional<double> refine_interval_s;
};

}  // namespace lodeline

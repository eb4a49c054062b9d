#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lodeline/pipeline/run_recording.h"
#include "lodeline/util/time/time.h"
#include "simulation/dive/scenario.h"

namespace lodeline {

/// What `lodeline compare` was asked for.
struct ComparisonRequest {
  std::vector<std::string> inputs;   ///< folders of recordings, or names of scenarios
  std::vector<std::string> methods;  ///< off, paper, absolute, azimuth
  int runs = 3;
  std::filesystem::path output;
  /// Simulated recordings are made here, or were; empty for a folder of the output.
  std::filesystem::path recordings;
  bool render = true;  ///< false: make do with the images that are there
  ScenarioChanges changes;
  int threads = 0;  ///< for rendering; 0 for all cores
  int cameras = 0;  ///< use the first so many; 0 for all
  RunRequest run;   ///< settings, calibration, site and date of every run
};

/// One run to be made: where its readings are, and what tells it from the others.
struct ComparisonSeed {
  std::string name;            ///< in words: "noise 2", "features 3"
  std::filesystem::path data;  ///< folder with mav0
  int feature_seed = 1;        ///< setting front_end.seed
};

/// A recording made ready.
struct ComparisonInput {
  std::string name;    ///< of letters, digits and -._
  std::string origin;  ///< in words
  std::vector<ComparisonSeed> seeds;
  RunRequest run;  ///< with calibration, site, date and cameras filled in; data and output are a run's own
  std::vector<Time> expected_stamps;  ///< of the first camera's images that are there and asked for
  std::string extent;                 ///< in words: in full, or which part
};

/// Makes ready what `input` names: a scenario is simulated, as far as it has not been (sensors once a noise
/// seed, images once), and its rig's magnetometer calibrated with `figure_eight` where no calibration is
/// given; a folder is taken as it is and its runs differ by the front end's seed. Where the rest of the
/// images is not there, the part before is taken. Throws UsageError and InputError; EstimationError where the
/// magnetometer cannot be calibrated. Returns false where the user ended the simulation.
bool prepareComparison(const std::string& input, const ComparisonRequest& request, ComparisonInput* prepared);

}  // namespace lodeline

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/lodeline/batch/batch_worker.h"
#include "apps/lodeline/shared/run_arguments.h"
#include "lodeline/pipeline/run_recording.h"
#include "lodeline/simulation.h"
#include "lodeline/trajectory.h"
#include "lodeline/types.h"

namespace lodeline {

/// Arguments of `lodeline compare`.
struct ComparisonRequest {
  std::vector<std::string> inputs;   ///< folders of recordings, or names of scenarios
  std::vector<std::string> methods;  ///< off, paper, absolute, azimuth
  int runs = 3;
  std::filesystem::path output;
  /// Folder of simulated recordings, new or existing; empty for a folder in the output.
  std::filesystem::path recordings;
  bool render = true;  ///< false: use only the existing images
  ScenarioChanges changes;
  int threads = 0;         ///< for rendering; 0 for all cores
  RunArguments arguments;  ///< of every run, from the command line
  RunRequest run;          ///< the same as one request
  BatchWork work;          ///< how the runs are made
};

/// One run to be made: its recording, and its difference to the others.
struct ComparisonSeed {
  std::string name;            ///< in words: "noise 2", "features 3"
  std::filesystem::path data;  ///< folder with mav0
  int feature_seed = 1;        ///< setting front_end.seed
};

/// A recording ready for the comparison.
struct ComparisonInput {
  std::string name;    ///< of letters, digits and -._
  std::string origin;  ///< description
  std::vector<ComparisonSeed> seeds;
  RunRequest run;  ///< with calibration, site, date and cameras; data and output are set per run
  Trajectory truth;
  std::vector<Time> expected_stamps;  ///< of the first camera's images that exist and are used
  std::string extent;                 ///< the part that is used, in words
};

/// Prepares the recording `input` and reads its ground truth. A scenario is simulated, unless it exists
/// (sensors once per noise seed, images once). Its rig's magnetometer is calibrated with `figure_eight` where
/// no calibration is given. A folder is used as it is, and its runs differ by the front end's seed. If images
/// are missing at the end, the part before is used. Throws UsageError and InputError; EstimationError where
/// the magnetometer cannot be calibrated. Returns false where the user ended the simulation.
bool prepareComparison(const std::string& input, const ComparisonRequest& request, ComparisonInput* prepared);

}  // namespace lodeline

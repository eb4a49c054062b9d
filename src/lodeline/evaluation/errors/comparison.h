#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/evaluation/errors/run_errors.h"

namespace lodeline {

/// One run of one method on one recording.
struct ComparedRun {
  std::string seed;                 ///< distinguishes it from the other runs, in words
  std::optional<RunErrors> errors;  ///< empty where it gave no trajectory
  std::string failure;              ///< the reason where there are no errors
  double completion = 0.0;          ///< share of the images with a pose, 0 to 1
  double core_ms_per_frame = 0.0;   ///< zero where it was not measured
};

struct ComparedMethod {
  std::string name;
  std::vector<ComparedRun> runs;
};

struct ComparedRecording {
  std::string name;
  std::string extent;  ///< the evaluated part: all, or an excerpt, in words
  std::vector<ComparedMethod> methods;
};

/// Means over the runs that have errors.
struct MethodMeans {
  int runs = 0;                              ///< with errors
  int total_runs = 0;                        ///< all of them
  HeadingBasis basis = HeadingBasis::Start;  ///< North if all these runs have it
  PoseRmse sim3, yaw;
  double scale = 0.0;
  double heading_rmse_deg = 0.0;
  double end_point_percent = 0.0;
  double end_point_equal_start_percent = 0.0;
  double relative_yaw_deg = 0.0;
  double relative_yaw_growth_deg = 0.0;
  double completion = 0.0;  ///< over all runs, including failed ones
  double core_ms_per_frame = 0.0;
};

MethodMeans meansOf(const ComparedMethod& method);

/// The method to which others are compared: that named "off", else the first; null without methods.
const ComparedMethod* baselineOf(const ComparedRecording& recording);

}  // namespace lodeline

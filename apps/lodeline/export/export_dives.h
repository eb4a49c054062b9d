#pragma once

#include <string>
#include <vector>

#include "apps/lodeline/export/export_depth.h"
#include "apps/lodeline/export/export_foxglove.h"
#include "apps/lodeline/shared/common_options.h"
#include "lodeline/output/survey/map/dive_map.h"
#include "lodeline/pipeline/open_recording.h"

namespace lodeline {

/// Arguments of `lodeline export`.
struct ExportArguments {
  std::vector<std::string> runs;
  std::vector<std::string> formats;
  std::string output;
  bool overwrite = false;
  Verbosity verbosity;
  std::string recording;
  BagArguments bag;
  std::string entrance;
  std::vector<double> entrance_sigma = {3.0, 5.0};
  bool no_splays = false;
  DepthProfileArguments depth;
  FoxgloveArguments foxglove;
  DiveMapOptions map;
};

/// Reads the runs, writes their maps, and prints a summary. Several runs share one grid, and formats for
/// survey programs get a project file that joins them.
void exportRuns(ExportArguments arguments);

/// The same for runs that were read already; `arguments.runs` names them.
void exportDives(const ExportArguments& arguments, std::vector<RunFolder> runs, Diagnostics* diagnostics);

}  // namespace lodeline

#pragma once

#include <string>
#include <vector>

#include "apps/lodeline/export/export_depth.h"
#include "lodeline/output/survey/map/dive_map.h"
#include "lodeline/pipeline/open_recording.h"

namespace lodeline {

/// What `lodeline export` is told.
struct ExportArguments {
  std::vector<std::string> runs;
  std::vector<std::string> formats;
  std::string output;
  bool overwrite = false;
  std::string recording;
  BagArguments bag;
  std::vector<std::string> entrance;
  std::vector<double> entrance_sigma = {3.0, 5.0};
  bool no_splays = false;
  DepthProfileArguments depth;
  DiveMapOptions map;
};

/// Reads the runs, makes their maps and writes them, and prints what was done. Several runs lie on one grid,
/// and formats for survey programs get a project that joins them.
void exportRuns(const ExportArguments& arguments);

}  // namespace lodeline

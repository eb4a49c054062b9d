#pragma once

#include <string>

#include "apps/lodeline/shared/common_options.h"
#include "lodeline/output/walls/walls.h"
#include "lodeline/pipeline/open_recording.h"

namespace lodeline {

/// Arguments of `lodeline walls`.
struct WallsArguments {
  std::string run, output, recording;
  BagArguments bag;
  std::string entrance;
  DiveMapOptions map;
  WallOptions walls;
  RecordingPart part;  ///< from the first pose
  bool one_camera = false, overwrite = false, keep_work = false;
  Verbosity verbosity;
};

/// Makes the walls of a run, writes their files and walls.json, and prints a summary. Throws Interruption
/// where the user ended the work.
void makeRunWalls(const WallsArguments& arguments);

}  // namespace lodeline

#pragma once

#include <string>

#include "lodeline/rig_calibration/problem/rig_state.h"

namespace lodeline {

/// How the lenses start.
struct LensStart {
  std::string model;        ///< for all cameras; empty: the stated ones
  bool keeps_lens = false;  ///< uses the stated lenses, even where they do not fit
};

/// First lenses, places of the cameras and poses of the board, from the views one by one. Cameras without a
/// stated lens get the model and the focal length for which their views fit best. The first camera is the
/// body, and the board frame the world. Leaves out views that do not fit. Throws EstimationError for a camera
/// without usable views, and for cameras that never see the board together with another one.
RigState startCameras(const BoardRecord& record, const LensStart& lens_start, Diagnostics* diagnostics);

}  // namespace lodeline

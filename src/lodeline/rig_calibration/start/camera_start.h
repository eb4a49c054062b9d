#pragma once

#include <string>

#include "lodeline/rig_calibration/problem/rig_state.h"

namespace lodeline {

/// First lenses, places of the cameras and poses of the board, from the views one by one. Cameras without a
/// stated lens get `model` and the focal length for which their views fit best. The first camera is the body,
/// and the board frame the world. Leaves out views that do not fit. Throws EstimationError for a camera
/// without usable views, and for cameras that never see the board together with another one.
RigState startCameras(const BoardRecord& record, const std::string& model, Diagnostics* diagnostics);

}  // namespace lodeline

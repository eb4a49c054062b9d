#pragma once

#include <optional>

#include "lodeline/cameras/camera.h"
#include "lodeline/rig_calibration/record/board_record.h"

namespace lodeline {

/// Pose of the board in a camera from one view: the homography of the plane of the board (T. Collins, A.
/// Bartoli, "Infinitesimal plane-based pose estimation", IJCV 2014). Behind a port the rays of the pixels
/// count as if they met. Nothing where too few corners have a ray.
std::optional<Rigid3> cameraFromBoard(const Camera& camera, const CalibrationBoard& board,
                                      const std::vector<BoardCorner>& corners);

/// Median distance between the corners and their projections, px; infinite where they do not project.
double medianError_px(const Camera& camera, const CalibrationBoard& board,
                      const std::vector<BoardCorner>& corners, const Rigid3& camera_from_board);

}  // namespace lodeline

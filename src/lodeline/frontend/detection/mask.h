#pragma once

#include <opencv2/core/mat.hpp>

#include "lodeline/rig.h"

namespace lodeline {

/// Loads the mask named in a camera's calibration, 8-bit, zero where no points may be detected; empty where
/// there is none. Throws InputError where the file cannot be read or has another size than the camera's
/// images.
cv::Mat loadMask(const CameraCalibration& calibration);

}  // namespace lodeline

#pragma once

#include <opencv2/core/mat.hpp>

#include "lodeline/sensors/rig.h"

namespace lodeline {

/// The mask that a camera's calibration names, 8-bit, zero where nothing may be detected; empty where it
/// names none. Throws InputError where the file cannot be read or has another size than the camera's images.
cv::Mat loadMask(const CameraCalibration& calibration);

}  // namespace lodeline

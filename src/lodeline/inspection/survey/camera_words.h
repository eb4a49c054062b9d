#pragma once

#include <string>

#include "lodeline/rig.h"

namespace lodeline {

/// Whether a camera has the parameters of a projection; one without a calibration file has not.
bool isCalibrated(const CameraCalibration& camera);

/// Viewing direction of a camera in words: "looks along the body's +x; the top of its image points along +z".
std::string describeAxes(const CameraCalibration& camera);

/// Direction of gravity in its image: "upright (gravity 5 deg off the image's downward direction)". `up_B`:
/// unit vector.
std::string describeGravity(const CameraCalibration& camera, const Vec3& up_B);

}  // namespace lodeline

#pragma once

#include <string>

#include "lodeline/sensors/rig.h"

namespace lodeline {

/// Whether it has what projecting takes; a camera without a calibration file has not.
bool isCalibrated(const CameraCalibration& camera);

/// Where a camera looks, in words: "looks along the body's +x; the top of its image points along +z".
std::string describeAxes(const CameraCalibration& camera);

/// Where gravity points in its image: "upright (gravity 5 deg off the image's downward direction)". `up_B`:
/// unit vector.
std::string describeGravity(const CameraCalibration& camera, const Vec3& up_B);

/// What is odd about a camera's own parameters, in words; empty where nothing is.
std::string oddIntrinsics(const CameraCalibration& camera);

}  // namespace lodeline

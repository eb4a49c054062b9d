#pragma once

#include <string>
#include <vector>

#include "lodeline/io/calibration/yaml_file.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Reads the camera keys common to EuRoC's sensor.yaml and Kalibr's camchain: `camera_model` (pinhole),
/// `resolution`, `intrinsics` (fx fy cx cy, px), `distortion_model` (radial-tangential or radtan,
/// equidistant, none) and the coefficients under `coefficients_key`. Throws InputError for anything else.
void readPinhole(const std::string& coefficients_key, CalibrationMap* map, CameraCalibration* camera);

}  // namespace lodeline

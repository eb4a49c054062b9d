#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/io/calibration/yaml_file.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Reads the camera keys common to EuRoC's sensor.yaml and Kalibr's camchain: `camera_model` (pinhole where
/// it is missing), `resolution`, `intrinsics`, `distortion_model` the coefficients under
/// `coefficients_key`, `port` where the camera looks through one, and the shutter. Throws InputError for a
/// model that is not registered, and for parameters that no lens has.
void readCameraModel(const std::string& coefficients_key, CalibrationMap* map, CameraCalibration* camera);

/// Reads the map `port` of a camera (docs/reference/file-formats.md); nothing where the camera has none.
/// Throws InputError for an unknown type or key, and for values that no port has.
std::optional<Port> readPort(CalibrationMap* camera);

/// The map `port` as text in one line, with all digits of the numbers.
std::string portText(const Port& port);

/// Reads the shutter of a camera: `shutter`, `line_delay_s`, Kalibr's `line_delay` (ns), `readout_s` and
/// `line_delay_sigma_s`. Without them it is global. Needs the camera's height. Throws InputError for values
/// that no shutter has.
void readShutter(CalibrationMap* map, CameraCalibration* camera);

/// The keys of a rolling shutter as lines of text; nothing for a global one.
std::string shutterText(const CameraCalibration& camera, const std::string& indent);

}  // namespace lodeline

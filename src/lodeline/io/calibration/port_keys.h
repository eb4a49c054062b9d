#pragma once

#include <optional>
#include <string>

#include "lodeline/io/calibration/yaml_file.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Reads the map `port` of a camera (docs/reference/file-formats.md); nothing where the camera has none.
/// Throws InputError for an unknown type or key, and for values that no port has.
std::optional<Port> readPort(CalibrationMap* camera);

/// The map as text in one line, with all digits of the numbers.
std::string portText(const Port& port);

}  // namespace lodeline

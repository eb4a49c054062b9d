#pragma once

#include <filesystem>

#include "lodeline/types.h"

namespace lodeline {

/// Reads the entry `T_BS` (body from sensor, 4x4, row by row) of a camera's sensor.yaml in EuRoC's layout.
/// Throws InputError when the file or the entry is missing or is not a rigid transformation.
Rigid3 readBodyFromCamera(const std::filesystem::path& path);

}  // namespace lodeline

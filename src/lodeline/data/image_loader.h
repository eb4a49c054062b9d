#pragma once

#include <filesystem>

#include "lodeline/data/measurement_source.h"

namespace lodeline {

/// Reads an image file as 8-bit grey, whatever it holds: colour is weighted to luminance, 16 bits are scaled
/// to 8. Never throws for a missing or damaged file; says so in the result.
LoadedImage loadGreyImage(const std::filesystem::path& file);

}  // namespace lodeline

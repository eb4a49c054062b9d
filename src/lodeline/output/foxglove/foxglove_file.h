#pragma once

#include <filesystem>

#include "lodeline/output/foxglove/foxglove_run.h"

namespace lodeline::foxglove {

/// Writes a run as an MCAP file with the frames `map`, `odom`, `base_link` and `refined`. The messages are in
/// the order of time. Whole paths, landmarks and findings have the time of the first pose. Throws InputError
/// where the file cannot be written.
void writeRun(const Run& run, const std::filesystem::path& file);

}  // namespace lodeline::foxglove

#pragma once

#include <filesystem>
#include <vector>

#include "lodeline/diagnostics.h"

namespace lodeline {

/// The files of one recording that GoPro cameras split: GX010042.MP4, GX020042.MP4, … (also GH, GS, GL), or
/// GOPR0042.MP4, GP010042.MP4, …. Returns `file` and the chapters after it that lie in the same folder, in
/// order, up to the first missing one; the file alone for other names. Reports as `chapter_missing` which one
/// is missing before another that is there, and as `chapter_left_out` the ones before `file`.
std::vector<std::filesystem::path> chaptersFrom(const std::filesystem::path& file, Diagnostics* diagnostics);

}  // namespace lodeline

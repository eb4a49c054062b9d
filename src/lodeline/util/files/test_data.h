#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace lodeline {

/// Root folder of the source tree, for scripts that tests run.
std::filesystem::path testSourceDir();

/// Folder with the recordings that tests marked REAL_TESTS read: environment variable LODELINE_DATA_DIR,
/// otherwise `shared/data` beside the source tree. Returns nothing where that folder does not exist; the
/// tests then skip.
std::optional<std::filesystem::path> testDataDir();

/// Path of a file or folder in testDataDir(). Returns nothing where it is missing; missingTestData() then
/// gives the reason to skip.
std::optional<std::filesystem::path> testData(const std::filesystem::path& name);

std::string missingTestData(const std::filesystem::path& name);

/// EuRoC MH_01_easy, stereo, the first 14 s of images.
inline constexpr const char* kMh01Recording = "euroc_mh01_stereo_14s";

}  // namespace lodeline

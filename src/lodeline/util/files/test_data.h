#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace lodeline {

/// The checkout, for scripts that tests run.
std::filesystem::path testSourceDir();

/// The folder with the recordings that tests marked REAL_TESTS read: environment LODELINE_DATA_DIR, otherwise
/// `shared/data` beside the source tree. Nothing where that folder does not exist; such tests then skip.
std::optional<std::filesystem::path> testDataDir();

/// A file or folder in testDataDir(); nothing where it is missing, for which missingTestData() is the reason
/// to skip.
std::optional<std::filesystem::path> testData(const std::filesystem::path& name);

std::string missingTestData(const std::filesystem::path& name);

/// EuRoC MH_01_easy, stereo, the first 14 s of images.
inline constexpr const char* kMh01Recording = "euroc_mh01_stereo_14s";

}  // namespace lodeline

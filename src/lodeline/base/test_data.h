#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>

namespace lodeline {

/// The folder with the recordings that tests marked REAL_TESTS read: environment LODELINE_DATA_DIR, otherwise
/// `shared/data` beside the source tree. Nothing where that folder does not exist; such tests then skip.
inline std::optional<std::filesystem::path> testDataDir() {
  const char* configured = std::getenv("LODELINE_DATA_DIR");
  const std::filesystem::path folder =
      configured != nullptr && *configured != '\0'
          ? std::filesystem::path(configured)
          : (std::filesystem::path(LODELINE_SOURCE_DIR) / ".." / "shared" / "data").lexically_normal();
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored)) return std::nullopt;
  return folder;
}

/// A file or folder in testDataDir(); nothing where it is missing, for which missingTestData() is the reason
/// to skip.
inline std::optional<std::filesystem::path> testData(const std::filesystem::path& name) {
  const std::optional<std::filesystem::path> folder = testDataDir();
  if (!folder || !std::filesystem::exists(*folder / name)) return std::nullopt;
  return *folder / name;
}

inline std::string missingTestData(const std::filesystem::path& name) {
  return name.string() + " not found; set LODELINE_DATA_DIR to the folder that holds it";
}

/// EuRoC MH_01_easy, stereo, the first 14 s of images.
inline constexpr const char* kMh01Recording = "euroc_mh01_stereo_14s";

}  // namespace lodeline

#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
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

}  // namespace lodeline

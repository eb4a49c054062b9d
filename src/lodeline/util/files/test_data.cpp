#include "lodeline/util/files/test_data.h"

#include <cstdlib>
#include <system_error>

namespace lodeline {

std::filesystem::path testSourceDir() { return LODELINE_SOURCE_DIR; }

std::optional<std::filesystem::path> testDataDir() {
  const char* configured = std::getenv("LODELINE_DATA_DIR");
  const std::filesystem::path folder = configured != nullptr && *configured != '\0'
                                           ? std::filesystem::path(configured)
                                           : (testSourceDir() / ".." / "shared" / "data").lexically_normal();
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored)) return std::nullopt;
  return folder;
}

std::optional<std::filesystem::path> testData(const std::filesystem::path& name) {
  const std::optional<std::filesystem::path> folder = testDataDir();
  if (!folder || !std::filesystem::exists(*folder / name)) return std::nullopt;
  return *folder / name;
}

std::string missingTestData(const std::filesystem::path& name) {
  return name.string() + " not found; set LODELINE_DATA_DIR to the folder that holds it";
}

}  // namespace lodeline

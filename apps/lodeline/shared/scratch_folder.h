#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "lodeline/diagnostics.h"

namespace lodeline {

/// A new folder among the temporary files, which the destructor removes with its content.
class ScratchFolder {
 public:
  /// Throws InputError where it cannot be made.
  ScratchFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "lodeline_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr)
      throw InputError(pattern + ": the folder cannot be made; set TMPDIR to one with free space");
    path_ = pattern;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace lodeline

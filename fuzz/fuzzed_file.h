#pragma once

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "lodeline/diagnostics.h"

namespace lodeline::fuzz {

/// A file in memory with the fuzzer's bytes, for readers that take a path. The name ends in `suffix`, from
/// which some readers determine the layout.
class FuzzedFile {
 public:
  FuzzedFile(const uint8_t* data, size_t size, const std::string& suffix)
      : folder_("/dev/shm/lodeline_fuzz_" + std::to_string(getpid())), path_(folder_ / ("input" + suffix)) {
    std::filesystem::create_directories(folder_);
    const int file = open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (file < 0 || write(file, data, size) != static_cast<ssize_t>(size)) std::abort();
    close(file);
  }
  ~FuzzedFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  FuzzedFile(const FuzzedFile&) = delete;
  FuzzedFile& operator=(const FuzzedFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_, path_;
};

/// Calls `read`. Accepts the errors that a reader documents; any other error ends the fuzzer.
template <typename Read>
int expectDocumentedErrors(const Read& read) {
  try {
    read();
  } catch (const InputError&) {
  } catch (const UsageError&) {
  }
  return 0;
}

}  // namespace lodeline::fuzz

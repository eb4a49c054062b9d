#include "lodeline/io/synchronizer/recording_file.h"

#include <fmt/core.h>

#include "lodeline/diagnostics.h"

namespace lodeline {

RecordingFile::RecordingFile(const std::filesystem::path& path) : path_(path) {
  std::error_code error;
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), error);
  stream_.open(path, std::ios::binary | std::ios::trunc);
  if (error || !stream_) {
    throw InputError(fmt::format("{}: cannot be written; choose another folder with -o", path.string()));
  }
}

void RecordingFile::write(const std::string& text) { stream_ << text; }

void RecordingFile::close() {
  stream_.close();
  if (!stream_)
    throw InputError(fmt::format("{}: could not be written in full; is the disk full?", path_.string()));
}

}  // namespace lodeline

#pragma once

#include <filesystem>
#include <fstream>

#include "lodeline/types.h"

namespace lodeline {

/// Writes poses in TUM format, one line each, flushed after each so that an interrupted run keeps its
/// results.
class PoseWriter {
 public:
  /// Throws InputError where the file cannot be written.
  explicit PoseWriter(const std::filesystem::path& file);

  /// Throws InputError when the disk is full.
  void write(Time time, const Rigid3& world_from_body);

 private:
  std::filesystem::path file_;
  std::ofstream stream_;
};

}  // namespace lodeline

#pragma once

#include <filesystem>
#include <fstream>

#include "lodeline/base/error.h"

namespace lodeline {

/// Opens a file of a run's output folder for writing, replacing what was there. Throws InputError naming it.
inline std::ofstream openOutput(const std::filesystem::path& file) {
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  if (!stream) {
    throw InputError(file.string() +
                     ": cannot be written; choose a folder with write permission and free space (-o)");
  }
  return stream;
}

}  // namespace lodeline

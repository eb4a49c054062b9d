#pragma once

#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

#include "lodeline/diagnostics.h"

namespace lodeline {

/// Creates a results folder where it is missing. Throws InputError naming the folder on failure.
inline void createOutputFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw InputError(folder.string() + ": cannot be created (" + error.message() +
                     "); choose another folder with -o");
  }
}

/// Opens an output file for writing and replaces its content. Throws InputError naming the file.
inline std::ofstream openOutput(const std::filesystem::path& file) {
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  if (!stream) {
    throw InputError(file.string() +
                     ": cannot be written; choose a folder with write permission and free space (-o)");
  }
  return stream;
}

/// Closes an output file. Throws InputError naming the file where a write failed.
inline void closeOutput(const std::filesystem::path& file, std::ofstream* stream) {
  stream->close();
  if (!*stream) throw InputError(file.string() + ": writing failed; is the disk full?");
}

inline void writeOutput(const std::filesystem::path& file, std::string_view content) {
  std::ofstream stream = openOutput(file);
  stream << content;
  closeOutput(file, &stream);
}

}  // namespace lodeline

#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"

namespace lodeline {

/// Arguments of `lodeline export` for the MCAP file.
struct FoxgloveArguments {
  bool is_wanted = false;
  bool with_pictures = false;
};
void addFoxgloveOptions(CLI::App* command, FoxgloveArguments* arguments);

/// Takes `mcap` out of the names of formats, in any case, and sets `is_wanted` where it is among them. Throws
/// UsageError for pictures without it.
void takeFoxglove(std::vector<std::string>* formats, FoxgloveArguments* arguments);

/// "NAME.mcap".
std::string foxgloveFileName(const std::string& name);

/// Writes the run of a folder as an MCAP file. Reports what is not reported about the folder yet.
void writeFoxglove(const FoxgloveArguments& arguments, const std::filesystem::path& run_folder,
                   const std::filesystem::path& file, Diagnostics* diagnostics);

}  // namespace lodeline

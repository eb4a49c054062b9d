#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <optional>
#include <string>

#include "lodeline/export/dive_map.h"

namespace lodeline {

/// What `lodeline export` is told of a depth profile.
struct DepthProfileArguments {
  std::string file;  ///< empty for none
  bool correct = false;
  std::optional<double> lag_s;
};
void addDepthOptions(CLI::App* command, DepthProfileArguments* arguments);

/// Aligns the profile with the run, writes `depth_profile.csv` (both over time) into the folder, and adds
/// what was found to the notes of the map. The start depth of the map becomes the profile's unless the user
/// stated it; with `correct`, the run's vertical becomes the profile's.
void applyDepthProfile(const DepthProfileArguments& arguments, const std::filesystem::path& folder,
                       bool start_depth_is_stated, RunFolder* run, DiveMapOptions* map,
                       Diagnostics* diagnostics);

}  // namespace lodeline

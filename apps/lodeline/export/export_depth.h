#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <optional>
#include <string>

#include "lodeline/output/survey/map/dive_map.h"

namespace lodeline {

/// What `lodeline export` is told of a depth profile.
struct DepthProfileArguments {
  std::string file;  ///< empty for none
  bool correct = false;
  std::optional<double> lag_s;
};
void addDepthOptions(CLI::App* command, DepthProfileArguments* arguments);

/// Aligns the profile with the run and adds what was found to the notes of the map. The start depth of the
/// map becomes the profile's unless the user stated it or the alignment is doubted; with `correct`, the run's
/// vertical becomes the profile's. Gives the text of `NAME_depth_profile.csv`, both over time.
std::string applyDepthProfile(const DepthProfileArguments& arguments, RunFolder* run, DiveMapOptions* map,
                              Diagnostics* diagnostics);

}  // namespace lodeline

#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <optional>
#include <string>

#include "lodeline/output/survey/map/dive_map.h"

namespace lodeline {

/// Arguments of `lodeline export` for a depth profile.
struct DepthProfileArguments {
  std::string file;  ///< empty for none
  std::string dive;  ///< number or date; empty where the log has one
  bool correct = false;
  std::optional<double> lag_s;
};
void addDepthOptions(CLI::App* command, DepthProfileArguments* arguments);

/// Aligns the profile with the run and adds the result to the notes of the map. The start depth of the map
/// becomes that of the profile unless the user stated it or the alignment is doubtful. With `correct`, the
/// profile corrects the run's depths. Returns the text of `NAME_depth_profile.csv`, with both over time.
std::string applyDepthProfile(const DepthProfileArguments& arguments, RunFolder* run, DiveMapOptions* map,
                              Diagnostics* diagnostics);

}  // namespace lodeline

#include "lodeline/cli/export_depth.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "lodeline/base/error.h"
#include "lodeline/export/depth_alignment.h"
#include "lodeline/export/map_times.h"

namespace lodeline {
namespace {

std::string comparisonCsv(const std::vector<DepthComparison>& pairs) {
  std::string text = "time [s],run_depth [m],profile_depth [m],profile_less_run [m]\n";
  for (const DepthComparison& pair : pairs) {
    text += fmt::format("{},{:.3f},{:.3f},{:.3f}\n", secondsText(pair.time), pair.run_depth_m,
                        pair.profile_depth_m, pair.profile_depth_m - pair.run_depth_m);
  }
  return text;
}

std::string describeAlignment(const DepthProfile& profile, const DepthAlignment& alignment) {
  return fmt::format(
      "depth profile: {}, its time + {:.2f} s (+- {:.2f} s) is the run's; {:.0f} s in common, first pose "
      "{:.2f} m "
      "deep, rms of the differences {:.3f} m, profile / run {:.3f}",
      profile.name, alignment.lag_s, alignment.lag_sigma_s, alignment.common_s, alignment.start_depth_m,
      alignment.rms_m, alignment.slope);
}

}  // namespace

void addDepthOptions(CLI::App* command, DepthProfileArguments* arguments) {
  CLI::Option* file =
      command->add_option("--depth-profile", arguments->file,
                          "CSV of a dive computer or a diver: time, depth; compared with the run");
  command->add_flag("--correct-depth", arguments->correct, "take the vertical from that profile")
      ->needs(file);
  command
      ->add_option("--profile-lag", arguments->lag_s,
                   "seconds to add to the profile's times; without it, they are found")
      ->needs(file);
}

std::string applyDepthProfile(const DepthProfileArguments& arguments, RunFolder* run, DiveMapOptions* map,
                              Diagnostics* diagnostics) {
  const DepthProfile profile = readDepthProfile(arguments.file, diagnostics);
  const DepthAlignment alignment = alignDepths(profile, run->trajectory, arguments.lag_s);
  if (!alignment.doubt.empty()) {
    const std::string doubt = fmt::format("{}: its lag is uncertain: {}", arguments.file, alignment.doubt);
    if (arguments.correct) {
      throw InputError(doubt + "; nothing was corrected: state the lag with --profile-lag SECONDS");
    }
    diagnostics->report(Severity::Warning, "profile_lag", doubt + "; --profile-lag SECONDS states it");
  }
  map->notes.push_back(describeAlignment(profile, alignment));
  const std::string comparison = comparisonCsv(compareDepths(profile, run->trajectory, alignment));
  double start_depth_m = alignment.start_depth_m;
  if (arguments.correct) {
    start_depth_m = correctDepths(profile, alignment, run);
    map->notes.push_back("vertical: corrected by the depth profile (difference smoothed over 20 s)");
  } else {
    map->notes.push_back("vertical: the run's own; the depth profile was only compared");
  }
  if (map->start_depth_m || !alignment.doubt.empty()) return comparison;
  map->start_depth_m = start_depth_m;
  map->start_depth_source = "by the depth profile";
  return comparison;
}

}  // namespace lodeline

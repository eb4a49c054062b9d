#include "apps/lodeline/export/export_depth.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/io/dives/dive_choice.h"
#include "lodeline/output/survey/depth/profile_fit.h"
#include "lodeline/output/survey/map/map_times.h"
#include "lodeline/util/time/time_steps.h"

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
  const DiveLabel& label = profile.label;
  const std::string dive =
      label.number + (label.number.empty() || label.start.empty() ? "" : " of ") + label.start;
  return fmt::format(
      "depth profile: {}{}, depths in {}, its time + {:.2f} s (+- {:.2f} s) is the run's; {:.0f} s in "
      "common, first pose "
      "{:.2f} m "
      "deep, rms of the differences {:.3f} m, profile / run {:.3f}",
      profile.name, dive.empty() ? "" : ", dive " + dive, profile.unit, alignment.lag_s,
      alignment.lag_sigma_s, alignment.common_s, alignment.start_depth_m, alignment.rms_m, alignment.slope);
}

/// Reports a difference between the start depths of the profile and of the run's own sensor. The profile's is
/// used, because the user asked for it.
void reportContradiction(double start_depth_m, const RunFolder& run, Diagnostics* diagnostics) {
  constexpr double kLeast_m = 0.5, kShare = 0.05;
  if (!run.depth_at_origin_m) return;
  const double difference_m = start_depth_m - *run.depth_at_origin_m;
  if (std::abs(difference_m) < std::max(kLeast_m, kShare * start_depth_m)) return;
  diagnostics->report(
      Severity::Warning, "start_depth_contradicted",
      fmt::format("the first pose was {:.2f} m deep by the depth profile, which is taken, and {:.2f} m by "
                  "the run's own pressure sensor",
                  start_depth_m, *run.depth_at_origin_m));
}

}  // namespace

void addDepthOptions(CLI::App* command, DepthProfileArguments* arguments) {
  CLI::Option* file =
      command->add_option("--depth-profile", arguments->file,
                          "log of a dive computer or a table of depths to compare with the run");
  command->add_option("--dive", arguments->dive, "number of the dive in that log, or the start of its date")
      ->needs(file);
  command->add_flag("--correct-depth", arguments->correct, "take the heights from that profile")->needs(file);
  command
      ->add_option("--profile-lag", arguments->lag_s,
                   "seconds to add to the times of the profile; without it, estimated")
      ->needs(file);
}

std::string applyDepthProfile(const DepthProfileArguments& arguments, RunFolder* run, DiveMapOptions* map,
                              Diagnostics* diagnostics) {
  if (!std::isfinite(arguments.lag_s.value_or(0.0)))
    throw UsageError("--profile-lag: a number of seconds is wanted");
  const std::vector<DepthProfile> dive =
      chooseDive(readDepthProfiles(arguments.file, diagnostics), arguments.dive);
  const ProfileFit fit = fitProfile(dive, run->trajectory, arguments.lag_s, diagnostics);
  const DepthProfile& profile = fit.profile;
  const DepthAlignment& alignment = fit.alignment;
  if (!alignment.doubt.empty()) {
    const std::string doubt = fmt::format("{}: it is doubtful whether this profile fits the run: {}",
                                          arguments.file, alignment.doubt);
    if (arguments.correct) {
      throw InputError(doubt + "; nothing was corrected: state the lag with --profile-lag SECONDS");
    }
    diagnostics->report(Severity::Warning, "profile_lag",
                        doubt + "; the map takes nothing from it; --profile-lag SECONDS states the lag");
  }
  map->notes.push_back(describeAlignment(profile, alignment));
  if (!alignment.doubt.empty())
    map->notes.push_back("depth profile: doubted, so the map takes nothing from it: " + alignment.doubt);
  const std::string comparison = comparisonCsv(compareDepths(profile, run->trajectory, alignment));
  double start_depth_m = alignment.start_depth_m;
  if (arguments.correct) {
    start_depth_m = correctDepths(profile, alignment, run);
    map->notes.push_back("vertical: corrected by the depth profile (difference smoothed over 20 s)");
  } else {
    map->notes.push_back("vertical: the run's own; the depth profile was only compared");
  }
  if (map->start_depth_m || !alignment.doubt.empty()) return comparison;
  reportContradiction(start_depth_m, *run, diagnostics);
  map->start_depth_m = start_depth_m;
  map->start_depth_source = "by the depth profile";
  return comparison;
}

}  // namespace lodeline

#include "lodeline/output/survey/depth/profile_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

/// A possible unit of depths that were read as metres, or in the unit stated by the log.
struct MistakenUnit {
  double factor;
  const char* words;
};
constexpr std::array<MistakenUnit, 6> kMistakenUnits = {{{0.3048, "feet"},
                                                         {1.0 / 0.3048, "metres that were taken for feet"},
                                                         {0.01, "centimetres"},
                                                         {100.0, "metres that were taken for centimetres"},
                                                         {0.001, "millimetres"},
                                                         {1000.0, "metres that were taken for millimetres"}}};

std::optional<DepthAlignment> align(const DepthProfile& profile, const Trajectory& trajectory,
                                    std::optional<double> known_lag_s) {
  try {
    return alignDepths(profile, trajectory, known_lag_s);
  } catch (const InputError&) {  // no time in common
    return std::nullopt;
  }
}

/// Checks whether a profile that fits badly fits in another unit.
void considerUnits(const Trajectory& trajectory, std::optional<double> known_lag_s, ProfileFit* fit,
                   std::string* finding) {
  constexpr double kMostSlopeError = 0.12, kMuchBetter = 0.5;
  std::optional<ProfileFit> better;
  const char* words = "";
  double best_factor = 1.0;
  for (const MistakenUnit& unit : kMistakenUnits) {
    ProfileFit other{scaled(fit->profile, unit.factor), {}};
    const std::optional<DepthAlignment> alignment = align(other.profile, trajectory, known_lag_s);
    if (!alignment || !alignment->doubt.empty() || std::abs(alignment->slope - 1.0) > kMostSlopeError)
      continue;
    if (alignment->rms_m > kMuchBetter * fit->alignment.rms_m) continue;
    if (better && better->alignment.rms_m <= alignment->rms_m) continue;
    other.alignment = *alignment;
    better = other;
    words = unit.words;
    best_factor = unit.factor;
  }
  if (!better) return;
  const std::string text = fmt::format("the depths fit as {} (profile / run {:.3g})", words,
                                       better->alignment.slope / best_factor);
  if (fit->profile.has_unit) {
    fit->alignment.doubt = text + ": the unit that the file states seems to be wrong";
    return;
  }
  *finding = text + "; taken so, since the file states no unit; state it in the header, as in 'depth [ft]'";
  *fit = *better;
}

}  // namespace

ProfileFit fitProfile(const std::vector<DepthProfile>& dives, const Trajectory& trajectory,
                      std::optional<double> known_lag_s, Diagnostics* diagnostics) {
  constexpr double kAlike = 1.5;
  std::vector<ProfileFit> fits;
  for (const DepthProfile& dive : dives) {
    if (const std::optional<DepthAlignment> alignment = align(dive, trajectory, known_lag_s))
      fits.push_back({dive, *alignment});
  }
  // Throws without common time.
  if (fits.empty()) fits.push_back({dives.front(), alignDepths(dives.front(), trajectory, known_lag_s)});
  const auto isBetter = [](const ProfileFit& a, const ProfileFit& b) {
    if (a.alignment.doubt.empty() != b.alignment.doubt.empty()) return a.alignment.doubt.empty();
    return a.alignment.rms_m < b.alignment.rms_m;
  };
  // All dives of a log have the same unit.
  std::vector<std::string> findings(fits.size());
  if (std::all_of(fits.begin(), fits.end(),
                  [](const ProfileFit& fit) { return !fit.alignment.doubt.empty(); })) {
    constexpr size_t kMostTried = 3;
    std::sort(fits.begin(), fits.end(), isBetter);
    for (size_t i = 0; i < std::min(kMostTried, fits.size()); ++i)
      considerUnits(trajectory, known_lag_s, &fits[i], &findings[i]);
  }
  const auto best = static_cast<size_t>(std::min_element(fits.begin(), fits.end(), isBetter) - fits.begin());
  ProfileFit result = fits[best];
  const std::string file = result.profile.name;
  if (dives.size() > 1) {
    diagnostics->report(Severity::Notice, "profile_dives",
                        fmt::format("{} has {} dives; the one in {} fits the run best", file, dives.size(),
                                    result.profile.dive));
  }
  for (size_t i = 0; i < fits.size(); ++i) {
    if (fits[i].profile.dive_number == result.profile.dive_number) continue;
    if (!result.alignment.doubt.empty() || !fits[i].alignment.doubt.empty()) continue;
    if (fits[i].alignment.rms_m > kAlike * std::max(result.alignment.rms_m, result.profile.resolution_m))
      continue;
    result.alignment.doubt = fmt::format("the dives in {} and {} fit alike; leave one of them in the file",
                                         result.profile.dive, fits[i].profile.dive);
  }
  if (!findings.empty() && !findings[best].empty())
    diagnostics->report(Severity::Warning, "profile_unit", file + ": " + findings[best]);
  return result;
}

}  // namespace lodeline

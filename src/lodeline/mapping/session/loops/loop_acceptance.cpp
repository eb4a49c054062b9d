#include "lodeline/mapping/session/loops/loop_acceptance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "lodeline/mapping/session/loops/field_support.h"

namespace lodeline {
namespace {

// Loops that must agree, the loop itself included.
constexpr size_t kNeededWithPrediction = 2;
constexpr size_t kNeededWithout = 3;
// Path along which loops are compared and wait, m. Odometry over it is accurate enough to tell false ones.
constexpr double kWaitingPath_m = 15.0;
constexpr size_t kMostAccepted = 10;

}  // namespace

std::vector<VerifiedLoop> LoopAcceptance::add(VerifiedLoop verified, const LoopEvidence& evidence,
                                              const KnownKeyframes& known) {
  const double path_m = known.at(verified.loop.new_keyframe).path_m;
  const int old_dive = known.at(verified.loop.old_keyframe).dive;
  waiting_.push_back({std::move(verified), evidence});
  const std::vector<Loop>& accepted = accepted_[old_dive];
  std::vector<Loop> loops(
      accepted.end() - static_cast<std::ptrdiff_t>(std::min(kMostAccepted, accepted.size())), accepted.end());
  const size_t known_good = loops.size();
  std::vector<size_t> waiting;  // index into waiting_ of each further loop
  for (size_t i = 0; i < waiting_.size(); ++i) {
    if (known.at(waiting_[i].verified.loop.old_keyframe).dive != old_dive) continue;
    waiting.push_back(i);
    loops.push_back(waiting_[i].verified.loop);
  }
  const ConsistentLoops agreeing =
      largestConsistentSet(loops, [&](KeyframeId from, KeyframeId to) { return known.between(from, to); });
  const auto good = static_cast<size_t>(std::count_if(agreeing.indices.begin(), agreeing.indices.end(),
                                                      [&](size_t i) { return i < known_good; }));
  // Loops that only agree with each other, and not with most of those in use, have to wait.
  if (2 * good < known_good) return {};
  std::vector<Loop> nearby;
  for (const size_t i : agreeing.indices) {
    if (std::abs(known.at(loops[i].new_keyframe).path_m - path_m) < kWaitingPath_m)
      nearby.push_back(loops[i]);
  }
  const bool has_field = areSupportedByField(nearby);
  std::vector<VerifiedLoop> decided;
  std::vector<size_t> used;
  for (const size_t i : agreeing.indices) {
    if (i < known_good) continue;
    Waiting& candidate = waiting_[waiting[i - known_good]];
    const bool is_predicted = candidate.evidence.has_prediction || known_good > 0;
    const size_t needed = is_predicted ? kNeededWithPrediction : kNeededWithout;
    if (agreeing.indices.size() < needed || (candidate.evidence.needs_field && !has_field)) continue;
    candidate.verified.loop.status = LoopStatus::Accepted;
    candidate.verified.loop.reason.clear();
    accepted_[old_dive].push_back(candidate.verified.loop);
    decided.push_back(std::move(candidate.verified));
    used.push_back(waiting[i - known_good]);
  }
  std::sort(used.rbegin(), used.rend());
  for (const size_t i : used) waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(i));
  return decided;
}

std::vector<VerifiedLoop> LoopAcceptance::expire(KeyframeId newest, const KnownKeyframes& known,
                                                 bool is_end) {
  const double path_m = known.at(newest).path_m;
  std::vector<VerifiedLoop> refused;
  std::vector<Waiting> still;
  for (Waiting& candidate : waiting_) {
    const double waited_m = path_m - known.at(candidate.verified.loop.new_keyframe).path_m;
    if (!is_end && waited_m < kWaitingPath_m) {
      still.push_back(std::move(candidate));
      continue;
    }
    candidate.verified.loop.status = LoopStatus::Refused;
    candidate.verified.loop.reason = fmt::format(
        "no other loop {}within {:.0f} m agrees with it",
        candidate.evidence.needs_field ? "at a place that the magnetic field supports " : "", kWaitingPath_m);
    refused.push_back(std::move(candidate.verified));
  }
  waiting_ = std::move(still);
  return refused;
}

}  // namespace lodeline

#include "lodeline/data/ordered_stream.h"

#include <fmt/core.h>

namespace lodeline {
namespace {

/// A step ahead of this size that the next reading takes back is a damaged stamp, not a pause.
constexpr Duration kWildLeap = Duration::fromNanoseconds(1'000'000'000);

}  // namespace

StampMonitor::Verdict StampMonitor::judge(Time candidate, Time following) {
  if (following > candidate) return Verdict::InOrder;
  if (following == candidate) {
    diagnostics_->report(Severity::Warning, expectation_.kind + "_duplicate",
                         fmt::format("{}: stamp {} ns occurs more than once; only the first is used",
                                     expectation_.name, following.nanoseconds()));
    return Verdict::DropFollowing;
  }
  const bool candidate_leapt = candidate - following > kWildLeap && (!last_ || following > *last_);
  diagnostics_->report(
      Severity::Warning, expectation_.kind + "_disorder",
      fmt::format("{}: time goes backwards from stamp {} ns to {} ns; the {} is dropped", expectation_.name,
                  candidate.nanoseconds(), following.nanoseconds(), candidate_leapt ? "former" : "latter"));
  return candidate_leapt ? Verdict::DropCandidate : Verdict::DropFollowing;
}

void StampMonitor::accept(Time time) {
  if (last_ && expectation_.max_gap_s > 0.0 && (time - *last_).seconds() > expectation_.max_gap_s) {
    diagnostics_->report(
        Severity::Warning, expectation_.kind + "_gap",
        fmt::format("{}: nothing for {:.3f} s after stamp {} ns (nominally {:g} Hz)", expectation_.name,
                    (time - *last_).seconds(), last_->nanoseconds(), expectation_.rate_hz));
  }
  last_ = time;
}

}  // namespace lodeline

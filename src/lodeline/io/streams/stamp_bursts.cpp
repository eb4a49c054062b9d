#include "lodeline/io/streams/stamp_bursts.h"

#include "lodeline/util/time/time_steps.h"
#include "lodeline/util/time/time_unit.h"

namespace lodeline {
namespace {

/// Thresholds as fractions of the mean step: shorter steps are within a burst, longer ones between bursts.
constexpr double kWithin = 0.5;
constexpr double kBetween = 1.5;
constexpr double kLeastShareWithin = 0.4;
constexpr int kFewestBursts = 3;

}  // namespace

std::optional<Duration> burstPeriod(const std::vector<Time>& stamps) {
  std::vector<double> since_first_ns;
  for (const Time stamp : stamps)
    since_first_ns.push_back(static_cast<double>(span(stamp, stamps.front()).nanoseconds()));
  const double rate_per_ns = stampsPerUnit(since_first_ns);
  if (!(rate_per_ns > 0.0)) return std::nullopt;
  const double period_ns = 1.0 / rate_per_ns;
  int within = 0, between = 0;
  for (size_t i = 1; i < stamps.size(); ++i) {
    const double step_ns = since_first_ns[i] - since_first_ns[i - 1];
    if (step_ns < 0.0) return std::nullopt;  // unordered stamps are handled elsewhere
    within += step_ns < kWithin * period_ns ? 1 : 0;
    between += step_ns > kBetween * period_ns ? 1 : 0;
  }
  const double share = static_cast<double>(within) / static_cast<double>(stamps.size() - 1);
  if (between < kFewestBursts || share < kLeastShareWithin) return std::nullopt;
  // The mean step is computed between complete bursts, because bursts at both ends may be incomplete.
  size_t first = 1, last = stamps.size() - 1;
  const auto isBetween = [&](size_t i) {
    return since_first_ns[i] - since_first_ns[i - 1] > kBetween * period_ns;
  };
  while (!isBetween(first)) ++first;
  while (!isBetween(last)) --last;
  const double span_ns = since_first_ns[last - 1] - since_first_ns[first - 1];
  return Duration::fromSeconds(1e-9 * span_ns / static_cast<double>(last - first));
}

bool BurstSpreader::separates(Time previous, Time next) const {
  return span(next, previous).seconds() > kWithin * period_.seconds();
}

std::vector<Time> BurstSpreader::spread(const std::vector<Time>& burst) {
  const auto count = static_cast<int64_t>(burst.size());
  int64_t span_ns = count * period_.nanoseconds();
  // A pause much longer than the burst is lost data, not a longer period.
  if (last_ && burst.back() > *last_ && span(burst.back(), *last_).nanoseconds() < span_ns + span_ns / 2)
    span_ns = span(burst.back(), *last_).nanoseconds();
  std::vector<Time> times;
  for (int64_t i = 1; i <= count; ++i)
    times.push_back(burst.back() - Duration::fromNanoseconds((count - i) * span_ns / count));
  last_ = burst.back();
  return times;
}

}  // namespace lodeline

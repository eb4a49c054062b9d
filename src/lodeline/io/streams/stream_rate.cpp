#include "lodeline/io/streams/stream_rate.h"

#include <fmt/core.h>

#include <algorithm>

#include "lodeline/diagnostics.h"
#include "lodeline/io/streams/stamp_bursts.h"
#include "lodeline/util/median.h"
#include "lodeline/util/time/time_steps.h"

namespace lodeline {
namespace {

/// Factor between the stated and the measured rate beyond which the stated one is wrong.
constexpr double kRateFactor = 1.5;
/// Minimum number of stamps that is treated as an error where they are equal or descend.
constexpr size_t kFewestStamps = 10;

void refuseStandingClock(const std::string& name, const std::vector<Time>& stamps,
                         const std::string& advice) {
  if (stamps.size() < kFewestStamps) return;
  if (std::any_of(stamps.begin(), stamps.end(), [&](Time stamp) { return stamp != stamps.front(); })) return;
  throw InputError(
      fmt::format("{}: the first {} readings all have the stamp {} ns, so that their times are "
                  "not known; {}",
                  name, stamps.size(), stamps.front().nanoseconds(), advice));
}

/// Throws for stamps that are 100, 1000 or 10^6 times as fast as stated, and faster than sensors usually are.
void refuseOtherUnit(const std::string& name, double measured_hz, double stated_hz) {
  constexpr double kSame = 1.1, kUnusual_hz = 1900.0;
  if (measured_hz < kUnusual_hz) return;
  for (const TimeUnit unit : {TimeUnit::Ticks, TimeUnit::Microseconds, TimeUnit::Milliseconds}) {
    const double factor = measured_hz / stated_hz / static_cast<double>(nanosecondsPer(unit));
    if (factor > kSame || factor < 1.0 / kSame) continue;
    throw InputError(fmt::format(
        "{}: the calibration says {:g} Hz but as nanoseconds the stamps come at {:.4g} Hz: they seem to "
        "count {}. Multiply them by {}, or state their unit in the header (`t [{}]`); if the sensor is that "
        "fast, correct the rate in the calibration",
        name, stated_hz, measured_hz, nameOf(unit), nanosecondsPer(unit), toString(unit)));
  }
}

}  // namespace

std::string storedInReverse(const std::string& name, Time former, Time latter) {
  return fmt::format(
      "{}: the readings are stored in reverse order: time goes backwards from stamp {} ns to {} ns and on; "
      "sort them by their stamps",
      name, former.nanoseconds(), latter.nanoseconds());
}

void refuseBadClock(const std::string& name, const std::vector<Time>& stamps, const std::string& advice) {
  refuseStandingClock(name, stamps, advice);
  if (stamps.size() < kFewestStamps || !std::is_sorted(stamps.rbegin(), stamps.rend())) return;
  throw InputError(storedInReverse(name, stamps.front(), stamps.back()));
}

std::optional<double> measuredRate_hz(const std::vector<Time>& stamps) {
  if (const std::optional<Duration> period = burstPeriod(stamps)) return 1.0 / period->seconds();
  std::vector<double> steps_s;
  for (size_t i = 1; i < stamps.size(); ++i) steps_s.push_back(span(stamps[i], stamps[i - 1]).seconds());
  const double step_s = median(std::move(steps_s));
  if (!(step_s > 0.0)) return std::nullopt;
  return 1.0 / step_s;
}

double settleRate(const std::string& name, const std::vector<Time>& stamps, double stated_hz,
                  Diagnostics* diagnostics, const std::string& advice) {
  refuseStandingClock(name, stamps, advice);
  const std::optional<double> measured_hz = measuredRate_hz(stamps);
  if (!measured_hz) return stated_hz;
  if (!(stated_hz > 0.0)) return *measured_hz;
  if (*measured_hz<stated_hz * kRateFactor&& * measured_hz> stated_hz / kRateFactor) return stated_hz;
  refuseOtherUnit(name, *measured_hz, stated_hz);
  diagnostics->report(
      Severity::Warning, "rate",
      fmt::format("{}: the calibration says {:g} Hz but the stamps come at {:.4g} Hz, which is used", name,
                  stated_hz, *measured_hz));
  return *measured_hz;
}

TimeUnit unitOfNanosecondStamps(const std::vector<double>& stamps, PlausibleRate rate) {
  if (areTicks(stamps, rate)) return TimeUnit::Ticks;
  const double rate_hz = stampsPerUnit(stamps) / secondsPer(TimeUnit::Nanoseconds);
  if (rate_hz <= 2.0 * rate.most_hz) return TimeUnit::Nanoseconds;
  return timeUnitOfStamps(stamps, rate).value_or(TimeUnit::Nanoseconds);
}

}  // namespace lodeline

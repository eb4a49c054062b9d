#include "lodeline/io/streams/stream_rate.h"

#include <fmt/core.h>

#include <algorithm>

#include "lodeline/diagnostics.h"
#include "lodeline/io/streams/stamp_bursts.h"
#include "lodeline/util/time/time_steps.h"

namespace lodeline {
namespace {

/// Factor between the stated and the measured rate beyond which the stated one is wrong.
constexpr double kRateFactor = 1.5;
/// Minimum number of equal stamps that is treated as an error.
constexpr size_t kFewestEqualStamps = 10;

void refuseStandingClock(const std::string& name, const std::vector<Time>& stamps,
                         const std::string& advice) {
  if (stamps.size() < kFewestEqualStamps) return;
  if (std::any_of(stamps.begin(), stamps.end(), [&](Time stamp) { return stamp != stamps.front(); })) return;
  throw InputError(
      fmt::format("{}: the first {} readings all have the stamp {} ns, so that their times are "
                  "not known; {}",
                  name, stamps.size(), stamps.front().nanoseconds(), advice));
}

}  // namespace

std::optional<double> measuredRate_hz(const std::vector<Time>& stamps) {
  if (const std::optional<Duration> period = burstPeriod(stamps)) return 1.0 / period->seconds();
  std::vector<double> steps_s;
  for (size_t i = 1; i < stamps.size(); ++i) steps_s.push_back(span(stamps[i], stamps[i - 1]).seconds());
  if (steps_s.empty()) return std::nullopt;
  const auto middle = steps_s.begin() + static_cast<std::ptrdiff_t>(steps_s.size() / 2);
  std::nth_element(steps_s.begin(), middle, steps_s.end());
  if (!(*middle > 0.0)) return std::nullopt;
  return 1.0 / *middle;
}

double settleRate(const std::string& name, const std::vector<Time>& stamps, double stated_hz,
                  Diagnostics* diagnostics, const std::string& advice) {
  refuseStandingClock(name, stamps, advice);
  const std::optional<double> measured_hz = measuredRate_hz(stamps);
  if (!measured_hz) return stated_hz;
  if (!(stated_hz > 0.0)) return *measured_hz;
  if (*measured_hz<stated_hz * kRateFactor&& * measured_hz> stated_hz / kRateFactor) return stated_hz;
  diagnostics->report(
      Severity::Warning, "rate",
      fmt::format("{}: the calibration says {:g} Hz but the stamps come at {:.4g} Hz, which is used", name,
                  stated_hz, *measured_hz));
  return *measured_hz;
}

TimeUnit unitOfNanosecondStamps(const std::vector<double>& stamps, PlausibleRate rate) {
  const double rate_hz = stampsPerUnit(stamps) / secondsPer(TimeUnit::Nanoseconds);
  if (rate_hz <= 2.0 * rate.most_hz) return TimeUnit::Nanoseconds;
  return timeUnitOfStamps(stamps, rate).value_or(TimeUnit::Nanoseconds);
}

}  // namespace lodeline

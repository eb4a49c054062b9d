#include "lodeline/io/tables/counter_wrap.h"

namespace lodeline {

int64_t CounterWrap::continued_ns(int64_t time_ns, int64_t ns_per_count) {
  constexpr int64_t kMostCounts = int64_t{1} << 32;
  const int64_t period_ns = kMostCounts * ns_per_count;
  // The counter restarted if it was in the last percent of its range and is now in the first percent.
  const auto isNearEnd = [&](int64_t ns) { return ns >= period_ns - period_ns / 100 && ns < period_ns; };
  const auto isNearStart = [&](int64_t ns) { return ns >= 0 && ns < period_ns / 100; };
  if (last_ns_ && isNearEnd(*last_ns_) && isNearStart(time_ns)) ++restarts_;
  // A late row from before the restart.
  if (last_ns_ && restarts_ > 0 && isNearStart(*last_ns_) && isNearEnd(time_ns)) --restarts_;
  last_ns_ = time_ns;
  return time_ns + restarts_ * period_ns;
}

}  // namespace lodeline

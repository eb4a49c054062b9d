#include "lodeline/util/time/time_steps.h"

#include <fmt/format.h>

namespace lodeline {

std::string secondsText(Time time) {
  const int64_t ns = time.nanoseconds();
  // The minimum of int64_t has no positive counterpart in int64_t.
  const uint64_t size_ns = ns < 0 ? uint64_t{0} - static_cast<uint64_t>(ns) : static_cast<uint64_t>(ns);
  return fmt::format("{}{}.{:09}", ns < 0 ? "-" : "", size_ns / 1'000'000'000, size_ns % 1'000'000'000);
}

}  // namespace lodeline

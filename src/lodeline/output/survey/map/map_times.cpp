#include "lodeline/output/survey/map/map_times.h"

#include <fmt/format.h>

#include <ctime>

namespace lodeline {

std::optional<std::string> isoTime(Time time) {
  constexpr int64_t kYear2000_s = 946684800, kYear2100_s = 4102444800;
  const int64_t seconds = time.nanoseconds() / 1000000000;
  if (seconds < kYear2000_s || seconds >= kYear2100_s) return std::nullopt;
  const auto clock = static_cast<std::time_t>(seconds);
  std::tm utc{};
  gmtime_r(&clock, &utc);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", utc.tm_year + 1900, utc.tm_mon + 1,
                     utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec, time.nanoseconds() / 1000000 % 1000);
}

}  // namespace lodeline

#include "lodeline/output/report/readable_times.h"

#include <fmt/format.h>

#include <cmath>
#include <regex>

#include "lodeline/util/csv_fields.h"

namespace lodeline {

std::string clockText(double seconds, int decimals) {
  const int64_t unit = decimals == 1 ? 10 : 1000;
  const auto units = static_cast<int64_t>(std::llround(std::abs(seconds) * static_cast<double>(unit)));
  const char* sign = seconds < 0.0 && units > 0 ? "-" : "";
  const int64_t whole_s = units / unit, hours = whole_s / 3600, minutes = whole_s / 60 % 60;
  const std::string rest = fmt::format("{:02}.{:0{}}", whole_s % 60, units % unit, decimals);
  if (hours > 0) return fmt::format("{}{}:{:02}:{}", sign, hours, minutes, rest);
  return fmt::format("{}{}:{}", sign, minutes, rest);
}

std::string withReadableTimes(const std::string& message, Time origin) {
  static const std::regex stamp("(-?[0-9]{5,19}) ns\\b");
  constexpr double kDay_s = 86400.0;
  std::string text;
  auto end = message.begin();
  for (std::sregex_iterator match(message.begin(), message.end(), stamp), last; match != last; ++match) {
    text.append(end, message.begin() + match->position());
    end = message.begin() + match->position() + match->length();
    int64_t stamp_ns = 0;
    const bool is_stamp = csv::parse(match->str(1), &stamp_ns);
    // Doubles, because their difference cannot overflow.
    const double since_s = (static_cast<double>(stamp_ns) - static_cast<double>(origin.nanoseconds())) * 1e-9;
    text += is_stamp && std::abs(since_s) < kDay_s ? clockText(since_s, 3) : match->str();
  }
  return text.append(end, message.end());
}

}  // namespace lodeline

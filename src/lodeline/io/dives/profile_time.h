#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace lodeline {

/// Time of a text in seconds, as parseCalendarTime_ns reads it.
std::optional<double> parseProfileTime(std::string_view text);

/// A date with a time of day as "YYYY-MM-DD HH:MM:SS"; empty for any other
/// text.
std::string profileStart(std::string_view date);

}  // namespace lodeline

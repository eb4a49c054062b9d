#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace lodeline {

/// Time of a text in seconds: of a clock reading, "1:15" or "0:01:15", of a
/// time of day, "3:04:05 PM", or since 1970 of a date with or without one:
/// "2026-11-21T12:00:00Z", "2026-11-21 12:00", "21.11.2026 12:00:00",
/// "11/21/2026 10:34 AM" (fractions and offsets like +02:00 too; without an
/// offset UTC). Empty for any other text, including plain numbers.
std::optional<double> parseProfileTime(std::string_view text);

/// A date with a time of day as "YYYY-MM-DD HH:MM:SS"; empty for any other
/// text.
std::string profileStart(std::string_view date);

}  // namespace lodeline

#pragma once

#include <optional>
#include <string_view>

namespace lodeline {

/// Seconds of a clock reading: "75.5", "1:15", "0:01:15", or since 1970 of "2026-11-21T12:00:00Z" (also with
/// a blank for the T, fractions, an offset like +02:00, and without one for UTC). `seconds_per_unit` is for
/// plain numbers. Nothing for any other text.
std::optional<double> parseProfileTime(std::string_view text, double seconds_per_unit);

}  // namespace lodeline

#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace lodeline {

/// Time of a text in nanoseconds: of a clock reading, "1:15" or "0:01:15", of a time of day, "3:04:05 PM", or
/// since 1970 of a date with or without one: "2026-11-21T12:00:00Z", "2026-11-21 12:00",
/// "21.11.2026 12:00:00", "21-Nov-2026 12:00:00", "11/21/2026 10:34 AM" (fractions and offsets like +02:00
/// too; without an offset UTC). Empty for any other text, including plain numbers.
std::optional<int64_t> parseCalendarTime_ns(std::string_view text);

}  // namespace lodeline

#pragma once

#include <optional>
#include <string>

#include "lodeline/types.h"

namespace lodeline {

/// ISO 8601 text "2026-11-21T12:00:00.107Z" of a stamp that counts from 1970 (between 2000 and 2100); empty
/// for a clock with another origin.
std::optional<std::string> isoTime(Time time);

}  // namespace lodeline

#pragma once

#include <optional>
#include <string>

#include "lodeline/util/time/time.h"

namespace lodeline {

/// "2026-11-21T12:00:00.107Z" of a stamp that counts from 1970 (between 2000 and 2100); nothing for a clock
/// that counts from somewhere else.
std::optional<std::string> isoTime(Time time);

}  // namespace lodeline

#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "lodeline/types.h"

/// Time arithmetic for unchecked stamps, which may have any 64-bit value. The functions saturate instead of
/// overflowing.
namespace lodeline {

/// `later` - `earlier`, saturated to the longest 64-bit duration.
constexpr Duration span(Time later, Time earlier) {
  int64_t ns = 0;
  if (!__builtin_sub_overflow(later.nanoseconds(), earlier.nanoseconds(), &ns))
    return Duration::fromNanoseconds(ns);
  return Duration::fromNanoseconds(later < earlier ? std::numeric_limits<int64_t>::min()
                                                   : std::numeric_limits<int64_t>::max());
}

/// `time` + `by`, saturated to the first or last 64-bit time.
constexpr Time moved(Time time, Duration by) {
  int64_t ns = 0;
  if (!__builtin_add_overflow(time.nanoseconds(), by.nanoseconds(), &ns)) return Time::fromNanoseconds(ns);
  return Time::fromNanoseconds(by.nanoseconds() < 0 ? std::numeric_limits<int64_t>::min()
                                                    : std::numeric_limits<int64_t>::max());
}

/// Seconds with nine decimals, formatted from the integer so that no digit is lost. Times before zero have
/// one sign in front: "-9.950000128".
std::string secondsText(Time time);

}  // namespace lodeline

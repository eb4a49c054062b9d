#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "lodeline/util/time/time.h"

/// What the stamps of a recording need that has not been looked at yet: they may be anything that 64 bits
/// hold.
namespace lodeline {

/// `later` - `earlier`; the longest span of 64 bits where it does not fit.
constexpr Duration span(Time later, Time earlier) {
  int64_t ns = 0;
  if (!__builtin_sub_overflow(later.nanoseconds(), earlier.nanoseconds(), &ns))
    return Duration::fromNanoseconds(ns);
  return Duration::fromNanoseconds(later < earlier ? std::numeric_limits<int64_t>::min()
                                                   : std::numeric_limits<int64_t>::max());
}

/// `time` + `by`; the first or last time of 64 bits where it does not fit.
constexpr Time moved(Time time, Duration by) {
  int64_t ns = 0;
  if (!__builtin_add_overflow(time.nanoseconds(), by.nanoseconds(), &ns)) return Time::fromNanoseconds(ns);
  return Time::fromNanoseconds(by.nanoseconds() < 0 ? std::numeric_limits<int64_t>::min()
                                                    : std::numeric_limits<int64_t>::max());
}

/// Seconds with nine decimals, from the integer so that no digit is lost; times before zero have one sign, in
/// front: "-9.950000128".
std::string secondsText(Time time);

}  // namespace lodeline

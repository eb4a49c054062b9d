#include "lodeline/io/streams/time_span.h"

#include <fmt/core.h>

#include <cmath>

#include "lodeline/util/time/time_steps.h"

namespace lodeline {

std::optional<std::string> apart(const std::string& name, const TimeSpan& span_of,
                                 const std::string& other_name, const TimeSpan& other,
                                 const std::string& offset) {
  const bool is_later = span_of.first > other.last;
  if (!is_later && other.first <= span_of.last) return std::nullopt;
  const Duration between = is_later ? span(span_of.first, other.last) : span(other.first, span_of.last);
  return fmt::format(
      "{} and {} have no time in common: {} from {} to {} ns, {} from {} to {} ns, which is {:.6g} s {} "
      "({:.6g} s from first to first). Two clocks, such as the time of day and the time since the device was "
      "switched on: stamp both by one clock, or set {} to the difference of the clocks",
      name, other_name, name, span_of.first.nanoseconds(), span_of.last.nanoseconds(), other_name,
      other.first.nanoseconds(), other.last.nanoseconds(), between.seconds(), is_later ? "earlier" : "later",
      std::abs(span(span_of.first, other.first).seconds()), offset);
}

}  // namespace lodeline

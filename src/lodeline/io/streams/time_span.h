#pragma once

#include <optional>
#include <string>

#include "lodeline/types.h"

namespace lodeline {

/// Times of the first and last reading of a stream.
struct TimeSpan {
  Time first, last;
};

/// Kind of the finding that two streams do not overlap in time.
inline constexpr const char* kClocksApart = "clocks_apart";

/// Message for two streams that do not overlap in time: both spans and the remedy. Returns nothing where they
/// overlap. `offset`: how to state the difference of the clocks, for example a key of the calibration.
std::optional<std::string> apart(const std::string& name, const TimeSpan& span, const std::string& other_name,
                                 const TimeSpan& other, const std::string& offset);

/// Accumulates the span of a stream reading by reading.
class SpanOfStream {
 public:
  void add(Time time) {
    if (!span_) span_ = {time, time};
    if (time < span_->first) span_->first = time;
    if (time > span_->last) span_->last = time;
  }
  const std::optional<TimeSpan>& get() const { return span_; }

 private:
  std::optional<TimeSpan> span_;
};

}  // namespace lodeline

#pragma once

#include <cstdint>
#include <optional>

namespace lodeline {

/// Times of a counter of 32 bits that starts again at zero, such as an Arduino's micros() every 71.6 minutes.
class CounterWrap {
 public:
  /// The time of a row, continued over all restarts before it. `ns_per_count`: nanoseconds per count.
  int64_t continued_ns(int64_t time_ns, int64_t ns_per_count);
  /// Number of restarts so far.
  int64_t restarts() const { return restarts_; }

 private:
  std::optional<int64_t> last_ns_;  ///< as read
  int64_t restarts_ = 0;
};

}  // namespace lodeline

#pragma once

#include <chrono>
#include <functional>
#include <optional>

#include "lodeline/types.h"

namespace lodeline {

/// Holds a run back, so that a recording is read at most `rate` times as fast as it was made.
class RunPace {
 public:
  /// `rate`: empty for as fast as possible. `is_stopped`: asked while it waits; true ends the waiting.
  RunPace(std::optional<double> rate, std::function<bool()> is_stopped);

  /// Returns when a frame of this time is due. The first frame is due at once. A run that is slower than
  /// `rate` does not hurry afterwards: time that was lost counts as part of the recording.
  void await(Time time);

 private:
  std::optional<double> rate_;
  std::function<bool()> is_stopped_;
  std::optional<Time> last_time_;
  std::chrono::steady_clock::time_point last_due_;
};

/// Waits until `is_ready` or `is_stopped`, which it asks each 20 ms.
void waitUntil(const std::function<bool()>& is_ready, const std::function<bool()>& is_stopped);

}  // namespace lodeline

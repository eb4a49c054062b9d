#pragma once

#include <chrono>
#include <string>

namespace lodeline {

/// Progress on standard error with per cent and remaining time: one line that is rewritten on a terminal, or
/// a line each ten seconds in a log.
class WallsProgress {
 public:
  explicit WallsProgress(bool quiet);

  void show(const std::string& stage, double share);
  /// Clears the line before other output.
  void end() const;

 private:
  using Clock = std::chrono::steady_clock;
  bool quiet_, terminal_;
  std::string stage_;
  Clock::time_point begin_, shown_;
};

}  // namespace lodeline

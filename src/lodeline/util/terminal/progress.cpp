#include "lodeline/util/terminal/progress.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "lodeline/util/terminal/terminal.h"

namespace lodeline {
namespace {

constexpr std::chrono::milliseconds kFirstPause(2000);  // on a terminal
constexpr std::chrono::milliseconds kTerminalPause(200);
constexpr std::chrono::milliseconds kLogPause(10'000);

std::string minutesText(double duration_s) {
  const auto seconds = static_cast<long>(std::ceil(duration_s));
  if (seconds < 3600) return fmt::format("{}:{:02}", seconds / 60, seconds % 60);
  return fmt::format("{}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60);
}

}  // namespace

std::string progressLine(const std::string& task, std::optional<double> share, double elapsed_s,
                         const std::string& words) {
  std::string line = task;
  if (share && std::isfinite(*share)) {
    const double done = std::clamp(*share, 0.0, 1.0);
    line += fmt::format("  {:3.0f} %", std::floor(100.0 * done));
    constexpr double kLeastShare = 0.005;  // below it, the rate is a guess
    if (done >= kLeastShare) line += fmt::format("  {} left", minutesText(elapsed_s * (1.0 - done) / done));
  }
  return words.empty() ? line : line + "  " + words;
}

Progress::Progress(std::string task, bool quiet)
    : task_(std::move(task)),
      quiet_(quiet),
      is_terminal_(terminal::width(stderr).has_value()),
      start_(Clock::now()),
      next_(start_ + (is_terminal_ ? kFirstPause : kLogPause)) {}

void Progress::begin(const std::string& task) {
  if (task == task_) return;
  task_ = task;
  start_ = Clock::now();
  next_ = start_ + (is_terminal_ ? kFirstPause : kLogPause);
}

bool Progress::isDue() const { return !quiet_ && Clock::now() >= next_; }

void Progress::show(std::optional<double> share, const std::string& words) {
  if (!isDue()) return;
  const Clock::time_point now = Clock::now();
  next_ = now + (is_terminal_ ? kTerminalPause : kLogPause);
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  const std::string line = progressLine(task_, share, elapsed_s, words);
  if (is_terminal_) {
    fmt::print(stderr, "\r\033[K{}", terminal::cut(line, *terminal::width(stderr) - 1));
    std::fflush(stderr);
  } else {
    fmt::print(stderr, "{}\n", line);
  }
  is_drawn_ = true;
}

void Progress::end() {
  if (is_drawn_ && is_terminal_) fmt::print(stderr, "\r\033[K");
  is_drawn_ = false;
}

}  // namespace lodeline

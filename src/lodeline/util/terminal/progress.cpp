#include "lodeline/util/terminal/progress.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "lodeline/diagnostics.h"
#include "lodeline/util/csv_fields.h"
#include "lodeline/util/terminal/terminal.h"

namespace lodeline {
namespace {

constexpr std::chrono::milliseconds kFirstPause(2000);  // on a terminal
constexpr std::chrono::milliseconds kTerminalPause(200);
constexpr std::chrono::milliseconds kRepeatPause(500);

/// Between two lines elsewhere than on a terminal.
std::chrono::milliseconds logPause() {
  const char* const text = std::getenv("LODELINE_PROGRESS_S");
  if (text == nullptr) return std::chrono::seconds(10);
  double pause_s = 0.0;
  if (!csv::parse(text, &pause_s) || !(pause_s >= 0.0 && pause_s <= 86400.0))
    throw UsageError(
        fmt::format("LODELINE_PROGRESS_S={}: a number of seconds from 0 to 86400 is wanted", text));
  return std::chrono::milliseconds(static_cast<long>(1000.0 * pause_s));
}

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
    : quiet_(quiet),
      is_terminal_(terminal::width(stderr).has_value()),
      pause_(logPause()),
      task_(std::move(task)) {
  restart();
  if (!quiet_) repeater_ = std::thread([this] { repeat(); });
}

Progress::~Progress() {
  end();
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  over_.notify_one();
  if (repeater_.joinable()) repeater_.join();
}

void Progress::restart() {
  share_.reset();
  words_.clear();
  start_ = Clock::now();
  next_ = start_ + (is_terminal_ ? kFirstPause : pause_);
}

void Progress::begin(const std::string& task) {
  const std::lock_guard lock(mutex_);
  is_open_ = true;
  if (task == task_) return;
  task_ = task;
  restart();
}

bool Progress::isDue() const {
  if (quiet_) return false;
  const std::lock_guard lock(mutex_);
  return Clock::now() >= next_;
}

void Progress::show(std::optional<double> share, const std::string& words) {
  if (quiet_) return;
  const std::lock_guard lock(mutex_);
  is_open_ = true;
  share_ = share;
  if (words != words_) words_ = words;
  const Clock::time_point now = Clock::now();
  if (now >= next_) draw(now);
}

void Progress::draw(Clock::time_point now) {
  next_ = now + (is_terminal_ ? kTerminalPause : pause_);
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  const std::string line = progressLine(task_, share_, elapsed_s, words_);
  if (is_terminal_) {
    fmt::print(stderr, "\r\033[K{}", terminal::cut(line, *terminal::width(stderr) - 1));
    std::fflush(stderr);
  } else {
    fmt::print(stderr, "{}\n", line);
  }
  is_drawn_ = true;
}

void Progress::repeat() {
  std::unique_lock lock(mutex_);
  while (!over_.wait_for(lock, kRepeatPause, [this] { return is_over_; })) {
    const Clock::time_point now = Clock::now();
    if (is_open_ && now >= next_ + kRepeatPause) draw(now);
  }
}

void Progress::end() {
  const std::lock_guard lock(mutex_);
  if (is_drawn_ && is_terminal_) fmt::print(stderr, "\r\033[K");
  is_drawn_ = is_open_ = false;
}

}  // namespace lodeline

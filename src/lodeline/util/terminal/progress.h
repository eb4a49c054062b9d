#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace lodeline {

/// Takes the share of a task that is done, from 0 to 1.
using ShareDone = std::function<void(double share)>;

/// Shows on the standard error stream how much of a long task is done: per cent, remaining time and words. On
/// a terminal it draws one line anew, from the third second on, no longer than the terminal is wide;
/// elsewhere it writes a line every ten seconds, or as often as LODELINE_PROGRESS_S says. A thread repeats
/// the last state with its new time while the task calls nothing, as in a solver or another program.
class Progress {
 public:
  /// `quiet`: show nothing. Throws UsageError where LODELINE_PROGRESS_S is no number of seconds.
  Progress(std::string task, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `share`: of the task, 0 to 1; nothing where the length of the task is unknown.
  void show(std::optional<double> share, const std::string& words = "");
  /// Goes on with another task, which has its own share and time; nothing happens where it has the same name.
  void begin(const std::string& task);
  /// Whether the next show() draws; saves the making of words.
  bool isDue() const;
  /// Removes the line from a terminal.
  void end();
  /// A function that shows each share it gets; this object must outlive it.
  ShareDone function() {
    return [this](double share) { show(share); };
  }

 private:
  using Clock = std::chrono::steady_clock;

  void restart();
  void draw(Clock::time_point now);
  void repeat();

  const bool quiet_, is_terminal_;
  const std::chrono::milliseconds pause_;  ///< elsewhere than on a terminal
  mutable std::mutex mutex_;               ///< for all below
  std::string task_, words_;
  std::optional<double> share_;
  bool is_open_ = true, is_drawn_ = false, is_over_ = false;
  Clock::time_point start_, next_;
  std::condition_variable over_;
  std::thread repeater_;
};

/// "TASK  41 %  2:05 left  WORDS". `elapsed_s`: since the start of the task.
std::string progressLine(const std::string& task, std::optional<double> share, double elapsed_s,
                         const std::string& words);

}  // namespace lodeline

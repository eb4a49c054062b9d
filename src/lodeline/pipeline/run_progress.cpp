#include "lodeline/pipeline/run_progress.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>

namespace lodeline {
namespace {

constexpr std::chrono::milliseconds kTerminalPause(200);
constexpr std::chrono::milliseconds kLogPause(5000);

}  // namespace

RunProgress::RunProgress(bool quiet)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO)), last_(std::chrono::steady_clock::now()) {}

void RunProgress::show(const RunSummary& summary) {
  const auto now = std::chrono::steady_clock::now();
  if (quiet_ || now - last_ < (terminal_ ? kTerminalPause : kLogPause)) return;
  last_ = now;
  const FrameEstimate& frame = summary.last();
  const std::string state =
      frame.status == Status::Waiting
          ? "waiting for " + frame.waiting_for
          : fmt::format("{}, {} tracks, {} landmarks", toString(frame.status), frame.tracks, frame.landmarks);
  fmt::print(stderr, "{}frame {:6}  {:5.1f} x real time  {:.1f} m  {}{}", terminal_ ? "\r\033[K" : "",
             summary.frames(), summary.realTimeFactor(), summary.pathLength_m(), state,
             terminal_ ? "" : "\n");
}

void RunProgress::end() const {
  if (!quiet_ && terminal_) fmt::print(stderr, "\r\033[K");
}

}  // namespace lodeline

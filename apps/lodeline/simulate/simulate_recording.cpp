#include "apps/lodeline/simulate/simulate_recording.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>

#include "lodeline/pipeline/stop_request.h"

namespace lodeline {
namespace {

using Clock = std::chrono::steady_clock;

/// Progress: one line that is rewritten on a terminal, or a line every half minute in a log.
class RenderProgress {
 public:
  explicit RenderProgress(bool quiet)
      : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0), begin_(Clock::now()) {}

  void show(const ImageProgress& progress) {
    const auto now = Clock::now();
    const bool last = progress.done == progress.total;
    if (quiet_ || (!last && now - shown_ < std::chrono::milliseconds(terminal_ ? 300 : 30000))) return;
    shown_ = now;
    const double elapsed_s = std::chrono::duration<double>(now - begin_).count();
    const double each_s = elapsed_s / static_cast<double>(std::max<size_t>(1, progress.rendered));
    fmt::print(stderr, "{}{} of {} images, {:.0f} ms each, {:.0f} s to go{}", terminal_ ? "\r" : "",
               progress.done, progress.total, 1e3 * each_s,
               each_s * static_cast<double>(progress.total - progress.done), terminal_ ? "   " : "\n");
    if (last && terminal_) fmt::print(stderr, "\n");
  }

 private:
  bool quiet_, terminal_;
  Clock::time_point begin_, shown_;
};

}  // namespace

RecordingSummary simulateRecording(const Scenario& scenario, const std::filesystem::path& folder,
                                   const SimulationRun& run) {
  const StopRequest stop;
  RenderProgress progress(run.quiet);
  ImageRecordingOptions options;
  options.threads = run.threads;
  options.stop = [&] { return stop.made(); };
  options.progress = [&](const ImageProgress& p) { progress.show(p); };
  const auto stage = [&](const char* what) {
    if (!run.quiet) fmt::print(stderr, "{}: {}\n", scenario.name, what);
  };
  return recordScenario(scenario, folder, options, stage);
}

}  // namespace lodeline

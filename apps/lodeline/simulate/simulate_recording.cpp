#include "apps/lodeline/simulate/simulate_recording.h"

#include <fmt/core.h>

#include <algorithm>

#include "lodeline/pipeline/stop_request.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {
RecordingSummary simulateRecording(const Scenario& scenario, const std::filesystem::path& folder,
                                   const SimulationRun& run) {
  const StopRequest stop;
  Progress progress("rendering", run.quiet);
  ImageRecordingOptions options;
  options.threads = run.threads;
  options.stop = [&] { return stop.made(); };
  options.progress = [&](const ImageProgress& p) {
    const double share = static_cast<double>(p.done) / static_cast<double>(std::max<size_t>(1, p.total));
    progress.show(share, fmt::format("{} of {} images", p.done, p.total));
  };
  const auto stage = [&](const char* what) {
    if (!run.quiet) fmt::print(stderr, "{}: {}\n", scenario.name, what);
  };
  return recordScenario(scenario, folder, options, stage);
}

}  // namespace lodeline

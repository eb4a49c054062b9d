#include "apps/lodeline/evaluation_page.h"

#include <fmt/core.h>

#include <filesystem>
#include <limits>

#include "apps/lodeline/shared/scratch_folder.h"
#include "lodeline/output/files/state_writer.h"
#include "lodeline/output/report/page/report_page.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

/// Writes a run's folder with the poses of a trajectory, whose uncertainty is unknown.
void writeAsRun(const Trajectory& trajectory, const fs::path& folder) {
  fs::create_directories(folder);
  StateWriter states(folder);
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  for (const StampedPose& pose : trajectory.poses) {
    FrameEstimate frame;
    frame.time = pose.time;
    frame.status = Status::Tracking;
    frame.state.world_from_body = pose.world_from_body;
    frame.covariance.setConstant(kUnknown);
    frame.posterior_covariance.setConstant(kUnknown);
    states.write(frame);
  }
}

}  // namespace

std::string evaluationPage(const std::vector<PageEstimate>& estimates, const ReportReference& reference,
                           const ShareDone& progress, Diagnostics* diagnostics) {
  const ScratchFolder scratch;
  std::vector<fs::path> runs;
  for (const PageEstimate& estimate : estimates) {
    const bool is_run = fs::exists(fs::path(estimate.path) / "states.csv");
    runs.push_back(is_run ? fs::path(estimate.path) : scratch.path() / estimate.name);
    if (!is_run) writeAsRun(*estimate.trajectory, runs.back());
  }
  ReportOptions options;
  options.reference = reference;
  options.progress = progress;
  return reportPage(runs, options, diagnostics);
}

}  // namespace lodeline

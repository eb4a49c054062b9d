#include "apps/lodeline/evaluation_page.h"

#include <fmt/core.h>
#include <unistd.h>

#include <filesystem>
#include <limits>

#include "lodeline/output/files/state_writer.h"
#include "lodeline/output/report/page/report_page.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

/// A folder that exists as long as this object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (fs::temp_directory_path() / "lodeline_page_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr)
      throw InputError(pattern + ": no temporary folder can be made; set TMPDIR to a folder with free space");
    path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

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
                           Diagnostics* diagnostics) {
  const TemporaryFolder temporary;
  std::vector<fs::path> runs;
  for (const PageEstimate& estimate : estimates) {
    const bool is_run = fs::exists(fs::path(estimate.path) / "states.csv");
    runs.push_back(is_run ? fs::path(estimate.path) : temporary.path() / estimate.name);
    if (!is_run) writeAsRun(*estimate.trajectory, runs.back());
  }
  ReportOptions options;
  options.reference = reference;
  return reportPage(runs, options, diagnostics);
}

}  // namespace lodeline

#include "lodeline/pipeline/refine_run.h"

#include "lodeline/output/files/landmark_writer.h"
#include "lodeline/output/files/state_writer.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {
namespace {

constexpr const char* kSuffix = "_refined";
constexpr const char* kLandmarks = "landmarks_refined.ply";

}  // namespace

RefinementSummary refineRun(const Estimator& estimator, const EstimatorLog& record, const LoopClosures& loops,
                            const std::filesystem::path& folder, const std::map<Time, Time>& result_stamps,
                            bool quiet, Diagnostics* diagnostics) {
  Progress progress("refinement", quiet);
  RefinementOptions options;
  options.progress = progress.function();
  const Refinement refinement = refine(estimator.rig(), estimator.options(), record, loops, options);
  progress.end();
  const RefinementSummary& summary = refinement.summary;
  if (!summary.usable()) {
    diagnostics->report(Severity::Serious, "refinement_refused",
                        "no refined trajectory: " + summary.refusal + "; use trajectory.tum");
    return summary;
  }
  if (!summary.converged) {
    diagnostics->report(Severity::Warning, "refinement_not_converged",
                        "refinement: its last round ended before the cost had settled");
  }
  {
    StateWriter states(folder, kSuffix, estimator.sensorColumns());
    std::optional<Time> last;
    for (FrameEstimate frame : refinement.frames) {
      if (const auto stamp = result_stamps.find(frame.time); stamp != result_stamps.end())
        frame.time = stamp->second;
      if (last && frame.time <= *last) continue;
      states.write(frame);
      last = frame.time;
    }
  }
  const MagnetometerEstimate& north = refinement.frames.back().sensors.of<MagnetometerEstimate>();
  std::optional<WorldTurn> turn = WorldTurn::of(north);
  if (turn) turn->north_found.reset();  // all frames are relative to it
  if (turn) turnStateFiles(folder, kSuffix, *turn);
  LandmarkWriter landmarks(folder, kLandmarks);
  landmarks.write(refinement.landmarks);
  landmarks.finish(north.heading_reference, turn);
  return summary;
}

void removeRefinedFiles(const std::filesystem::path& folder) {
  for (const char* name : {"trajectory_refined.tum", "states_refined.csv", kLandmarks})
    std::filesystem::remove(folder / name);
}

}  // namespace lodeline

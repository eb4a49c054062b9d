// Compares the depths of the keyframes of a simulated dive with the simulator's exact surface, by depth and
// by angle: with the poses of the run, and with the exact ones, which leave the errors of the depths alone.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>

#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/output/survey/formats/recording_images.h"
#include "lodeline/output/survey/map/dive_map.h"
#include "lodeline/output/survey/map/pose_at.h"
#include "studies/walls/depth_errors.h"

namespace {

using namespace lodeline;

struct DepthArguments {
  std::string recording, run, work, scenario = "cave1_short";
  double from_s = 0.0, to_s = 1e9;
  bool one_camera = false;
  ScenarioChanges changes;
};

void studyDepths(const DepthArguments& arguments) {
  const Scenario scenario = makeScenario(arguments.scenario, arguments.changes);
  if (!holdsRecording(scenario, arguments.recording))
    throw InputError(arguments.recording + ": another scenario; give the options of `lodeline simulate`");
  Diagnostics diagnostics;
  RunFolder run = readRunFolder(arguments.run, &diagnostics);
  const Time begin = run.trajectory.poses.front().time;
  const Trajectory true_poses = readTrajectory(arguments.recording, {}, diagnostics);
  const PosePairs pairs = associate(run.trajectory, true_poses, {AssociationMethod::Interpolate, 0.1, 0.0});
  const Rigid3 truth_from_map = align(AlignmentType::Yaw, pairs).reference_from_estimate;
  std::erase_if(run.trajectory.poses, [&](const StampedPose& pose) {
    const double since_s = (pose.time - begin).seconds();
    return since_s < arguments.from_s || since_s > arguments.to_s;
  });
  EurocSource source(arguments.recording, {}, &diagnostics);
  std::vector<CameraCalibration> cameras = camerasOfRun(source.rig(), run);
  cameras.resize(std::min<size_t>(cameras.size(), arguments.one_camera ? 1 : 2));
  const DiveDepthOptions options;
  const DepthStore store(arguments.work);
  const DiveDepths depths = computeDepths(
      source, cameras, run.trajectory, options, 1.0, store, [](const char*, double) { return true; },
      &diagnostics);
  const TrueSurface truth(scenario);
  const Rigid3 body_from_view = RectifiedView(cameras, options.rectification).body_from_view();
  fmt::print("poses of the run\n{}",
             depthErrorTables(depthErrors(depths.frames, truth, 6, [&](const auto& k) {
               return std::optional<Rigid3>(truth_from_map * k.map_from_view);
             })));
  fmt::print("exact poses\n{}", depthErrorTables(depthErrors(depths.frames, truth, 6, [&](const auto& k) {
               std::optional<Rigid3> pose = poseAt(true_poses, k.time);
               if (pose) *pose = *pose * body_from_view;
               return pose;
             })));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program("Compares the depths of a simulated dive's keyframes with the true surface");
  DepthArguments arguments;
  program.add_option("RECORDING", arguments.recording)->required();
  program.add_option("RUN", arguments.run)->required();
  program.add_option("WORK", arguments.work, "folder of the depths, which are kept")->required();
  program.add_option("--from", arguments.from_s);
  program.add_option("--to", arguments.to_s);
  program.add_flag("--one-camera", arguments.one_camera);
  program.add_option("--scenario", arguments.scenario);
  program.add_option("--realism", arguments.changes.realism);
  program.add_option("--metres", arguments.changes.metres);
  program.add_option("--seconds", arguments.changes.seconds);
  program.add_option("--seed", arguments.changes.seed);
  program.add_option("--camera-rate-hz", arguments.changes.camera_rate_hz);
  CLI11_PARSE(program, argc, argv);
  try {
    cv::setNumThreads(1);
    studyDepths(arguments);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}

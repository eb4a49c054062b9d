// Calls the estimator directly with feature tracks of a user's own front end and inertial readings. Here both
// come from a simulated dive with known ground truth:
//   example_2_feed_by_hand

#include <algorithm>
#include <cstdio>
#include <exception>

#include "lodeline/estimator/estimator.h"
#include "simulation/dive/point_dive.h"

int main() try {
  // A rig has cameras and an IMU with their calibrations; a real one is read from calibration files.
  lodeline::DiveMotionOptions motion;
  motion.duration_s = 30.0;
  motion.path_length_m = 4.0;
  const lodeline::MountedRig mounted = lodeline::standardRig({});
  const lodeline::ImuErrors imu_errors = lodeline::drawImuErrors(lodeline::imuGrade("gx5-25"), {}, 1);
  const lodeline::PointDive dive = lodeline::makePointDive(motion, mounted, imu_errors);
  lodeline::PointSimulationOptions simulation;
  simulation.imu = imu_errors;
  lodeline::PointSimulation sensors = dive.simulate(simulation);

  lodeline::Diagnostics diagnostics;
  lodeline::Estimator estimator(dive.mounted.rig, {}, &diagnostics);
  lodeline::Rigid3 truth_from_world;
  bool started = false;
  double worst_m = 0.0;
  int frames = 0;
  while (const auto frame = sensors.next()) {
    // One call per frame: the observations of the cameras, and the IMU readings since the previous frame,
    // with both ends at the frames' times.
    const lodeline::FrameEstimate estimate = estimator.add(frame->tracks, frame->imu);
    if (estimate.status == lodeline::Status::Waiting) continue;
    const lodeline::Rigid3& truth = frame->truth.motion.world_from_body;
    if (!started) truth_from_world = truth * estimate.state.world_from_body.inverse();
    started = true;
    const lodeline::Vec3 position = truth_from_world * estimate.state.world_from_body.translation;
    worst_m = std::max(worst_m, (position - truth.translation).norm());
    ++frames;
  }
  std::printf("%d frames with a pose, at most %.3f m from the truth\n", frames, worst_m);
  return frames > 0 && worst_m < 0.2 ? 0 : 3;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}

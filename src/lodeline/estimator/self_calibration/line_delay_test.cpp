// The line delay of a rolling shutter as a state, on points that are observed row after row.
#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/estimator/trials/scene.h"

namespace lodeline {
namespace {

constexpr double kReadout_s = 0.020;

struct ShutterRun {
  double position_rms_m = 0.0;
  std::vector<double> line_delays_s;
};

/// The rig with shutters as a data sheet describes them: 16.5 ms for all rows, give or take 10 ms.
Rig withRollingShutters(Rig rig) {
  for (CameraCalibration& camera : rig.cameras) {
    camera.line_delay_s = 0.0165 / camera.height_px;
    camera.line_delay_sigma_s = 0.010 / camera.height_px;
  }
  return rig;
}

/// Moves the observations of a frame to where the points are when their rows are exposed.
void readRowsOneByOne(const TestScene& scene, double line_delay_s, FrameTracks* tracks) {
  const double time_s = scene.secondsOf(tracks->time);
  for (FeatureObservation& observation : tracks->observations) {
    const CameraCalibration& calibration = scene.rig().cameras[static_cast<size_t>(observation.camera)];
    const auto camera = makeCamera(calibration);
    const auto pixelAt = [&](double seconds) {
      const Rigid3 world_from_camera =
          scene.motion().at(seconds).world_from_body * calibration.body_from_camera;
      return camera->project(world_from_camera.inverse() * scene.landmark(observation.track));
    };
    const auto at_once = pixelAt(time_s);
    auto by_rows = at_once;
    for (int i = 0; i < 5 && by_rows; ++i)
      by_rows = pixelAt(time_s + line_delay_s * (by_rows->y() - 0.5 * (calibration.height_px - 1)));
    if (!at_once || !by_rows) continue;
    observation.pixel += *by_rows - *at_once;
    if (const auto ray = camera->unproject(observation.pixel)) observation.bearing_C = *ray;
  }
}

ShutterRun runShutter(int cameras, uint64_t seed, double readout_s, bool rig_rolls) {
  TestSceneOptions options;
  options.seed = seed;
  options.cameras = cameras;
  options.duration_s = 30.0;
  options.points.tracks = 60;
  options.points.frame_rate_hz = 10.0;
  TestScene scene(options);
  const Rig rig = rig_rolls ? withRollingShutters(scene.rig()) : scene.rig();
  ComparedEstimator estimator(scene, honestOptions(options), rig);
  ShutterRun result;
  double squared = 0.0;
  int count = 0;
  while (auto frame = scene.next()) {
    readRowsOneByOne(scene, readout_s / rig.cameras.front().height_px, &frame->tracks);
    const Comparison comparison = estimator.add(*frame, SensorReadings{});
    if (!comparison.initialized()) continue;
    squared += comparison.positionError() * comparison.positionError();
    ++count;
    if (comparison.estimate.camera_corrections)
      result.line_delays_s = comparison.estimate.camera_corrections->line_delays_s;
  }
  EXPECT_GT(count, 80);
  result.position_rms_m = std::sqrt(squared / std::max(1, count));
  return result;
}

class LineDelay : public testing::TestWithParam<int> {};

TEST_P(LineDelay, IsFoundAndThePathIsAsGoodAsWithAGlobalShutter) {
  double global_m = 0.0, rolling_m = 0.0, ignored_m = 0.0;
  for (const uint64_t seed : {3, 4}) {
    const ShutterRun global = runShutter(GetParam(), seed, 0.0, false);
    EXPECT_TRUE(global.line_delays_s.empty());
    const ShutterRun rolling = runShutter(GetParam(), seed, kReadout_s, true);
    const double true_delay_s = kReadout_s / testRig(1).cameras.front().height_px;
    ASSERT_EQ(rolling.line_delays_s.size(), static_cast<size_t>(GetParam()));
    for (const double line_delay_s : rolling.line_delays_s)
      EXPECT_NEAR(line_delay_s, true_delay_s, 0.05 * true_delay_s) << "seed " << seed;
    global_m += global.position_rms_m;
    rolling_m += rolling.position_rms_m;
    ignored_m += runShutter(GetParam(), seed, kReadout_s, false).position_rms_m;
  }
  RecordProperty("global_mm", std::to_string(1e3 * global_m / 2.0));
  RecordProperty("rolling_mm", std::to_string(1e3 * rolling_m / 2.0));
  RecordProperty("ignored_mm", std::to_string(1e3 * ignored_m / 2.0));
  EXPECT_LE(rolling_m, 1.3 * global_m);
  // With one camera, the delay of the rows costs no accuracy in these scenes.
  if (GetParam() == 2) {
    EXPECT_GT(ignored_m, 1.5 * rolling_m);
  }
}

// A global shutter whose file calls it rolling: the line delay comes out as zero, although the prior
// expects 16.5 ms.
TEST_P(LineDelay, OfAGlobalShutterIsZero) {
  const ShutterRun result = runShutter(GetParam(), 6, 0.0, true);
  for (const double line_delay_s : result.line_delays_s)
    EXPECT_NEAR(line_delay_s * testRig(1).cameras.front().height_px, 0.0, 0.002);
}

INSTANTIATE_TEST_SUITE_P(Cameras, LineDelay, testing::Values(1, 2),
                         [](const auto& info) { return info.param == 1 ? "One" : "Two"; });

}  // namespace
}  // namespace lodeline

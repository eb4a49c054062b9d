#include "simulation/dive/point_simulation.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "lodeline/simulation.h"
#include "simulation/motion/dive_motion.h"

namespace lodeline {
namespace {

class PointSimulationTest : public testing::Test {
 protected:
  PointSimulationTest() {
    options_.end_s = 20.0;
    rig_.imu.rate_hz = 200.0;
  }

  static DiveMotionOptions motionOptions() {
    DiveMotionOptions options;
    options.duration_s = 100.0;
    options.path_length_m = 22.0;
    return options;
  }
  static CenterlineOptions passageOptions() {
    CenterlineOptions options;
    options.length_m = 11.0;
    return options;
  }

  std::vector<SimulatedFrame> run() {
    PointSimulation simulation(motion_, landmarks_, rig_, options_);
    std::vector<SimulatedFrame> frames;
    while (auto frame = simulation.next()) frames.push_back(std::move(*frame));
    return frames;
  }

  MountedRig mounted_ = standardRig({});
  Rig rig_ = mounted_.rig;
  Centerline passage_ = Centerline::generate(passageOptions());
  Motion motion_ = makeDiveMotion(passage_, motionOptions(), mounted_.diver_from_body);
  LandmarkField landmarks_ = passageLandmarks(passage_.translated(motion_.worldShift()), 80.0, 1);
  PointSimulationOptions options_;
};

TEST_F(PointSimulationTest, KeepsTracksInEveryFrame) {
  const auto frames = run();
  ASSERT_EQ(frames.size(), 381u);
  for (const SimulatedFrame& frame : frames) {
    std::set<TrackId> tracks;
    for (const FeatureObservation& o : frame.tracks.observations) tracks.insert(o.track);
    EXPECT_GE(tracks.size(), 135u);
    EXPECT_LE(tracks.size(), 150u);
    EXPECT_TRUE(std::is_sorted(frame.tracks.observations.begin(), frame.tracks.observations.end(),
                               [](const FeatureObservation& a, const FeatureObservation& b) {
                                 return std::tie(a.track, a.camera) < std::tie(b.track, b.camera);
                               }));
  }
}

TEST_F(PointSimulationTest, ReprojectionErrorsAreTheStatedNoise) {
  PointSimulation simulation(motion_, landmarks_, rig_, options_);
  std::vector<std::shared_ptr<const Camera>> cameras = {makeCamera(rig_.cameras[0]),
                                                        makeCamera(rig_.cameras[1])};
  double squares = 0.0;
  int count = 0;
  while (auto frame = simulation.next()) {
    for (const FeatureObservation& o : frame->tracks.observations) {
      const Rigid3 world_from_camera =
          frame->truth.motion.world_from_body * rig_.cameras[o.camera].body_from_camera;
      const Vec3 point_C = world_from_camera.inverse() * simulation.landmark(o.track);
      const auto pixel = cameras[o.camera]->project(point_C);
      ASSERT_TRUE(pixel.has_value());
      squares += (*pixel - o.pixel).squaredNorm();
      count += 2;
      const Vec2 again = *cameras[o.camera]->project(o.bearing_C);
      EXPECT_LT((again - o.pixel).norm(), 1e-5);
    }
  }
  EXPECT_GT(count, 100000);
  EXPECT_NEAR(std::sqrt(squares / count), 0.5, 0.005);
}

TEST_F(PointSimulationTest, InertialReadingsMeetAtTheFramesExactly) {
  for (const double frame_rate_hz : {20.0, 15.0, 7.3}) {
    options_.frame_rate_hz = frame_rate_hz;
    const auto frames = run();
    EXPECT_EQ(frames[0].imu.front().time, options_.start);
    for (size_t i = 0; i < frames.size(); ++i) {
      const auto& imu = frames[i].imu;
      EXPECT_EQ(imu.back().time, frames[i].tracks.time);
      if (i > 0) {
        EXPECT_EQ(imu.front().time, frames[i - 1].tracks.time);
        EXPECT_EQ(imu.front().angular_velocity_B, frames[i - 1].imu.back().angular_velocity_B);
      }
      for (size_t j = 1; j < imu.size(); ++j) {
        EXPECT_GT(imu[j].time, imu[j - 1].time);
        EXPECT_LE((imu[j].time - imu[j - 1].time).nanoseconds(), 5'000'001);
      }
    }
  }
}

TEST_F(PointSimulationTest, TrueBiasesAreThoseOfTheReadings) {
  options_.imu = drawImuErrors(imuGrade("gx5-25"), {}, 4);
  options_.imu.gyroscope.noise_density = 0.0;
  options_.imu.accelerometer.noise_density = 0.0;
  for (const SimulatedFrame& frame : run()) {
    const ImuSample perfect = perfectImuSample(frame.truth.motion, frame.truth.time, options_.gravity_W);
    EXPECT_LT(
        (frame.imu.back().angular_velocity_B - perfect.angular_velocity_B - frame.truth.gyroscope_bias_B)
            .norm(),
        1e-9);
    EXPECT_LT(
        (frame.imu.back().specific_force_B - perfect.specific_force_B - frame.truth.accelerometer_bias_B)
            .norm(),
        1e-9);
  }
}

TEST_F(PointSimulationTest, TracksEndAndNeverComeBackUnderTheirName) {
  options_.longest_track_s = 3.0;
  std::map<TrackId, double> first_seen, last_seen;
  for (const SimulatedFrame& frame : run()) {
    const double t = (frame.truth.time - options_.start).seconds();
    for (const FeatureObservation& o : frame.tracks.observations) {
      first_seen.try_emplace(o.track, t);
      last_seen.try_emplace(o.track, t);
      EXPECT_LT(t - last_seen[o.track], 0.051);
      last_seen[o.track] = t;
    }
  }
  for (const auto& [track, begin] : first_seen) EXPECT_LE(last_seen[track] - begin, 3.0 + 1e-6);
}

TEST_F(PointSimulationTest, DropsFramesAndGoesDarkWhenAsked) {
  options_.dropped_frame_share = 0.1;
  options_.blackouts = {{5.0, 3.0}};
  const auto frames = run();
  EXPECT_NEAR(static_cast<double>(frames.size()), 0.9 * 381, 20);
  int empty = 0;
  for (const SimulatedFrame& frame : frames) empty += frame.tracks.observations.empty();
  EXPECT_NEAR(empty, 54, 10);
  for (size_t i = 1; i < frames.size(); ++i) EXPECT_EQ(frames[i].imu.front().time, frames[i - 1].tracks.time);
}

TEST_F(PointSimulationTest, OutliersHaveTheirShare) {
  options_.outlier_share = 0.05;
  PointSimulation simulation(motion_, landmarks_, rig_, options_);
  const auto camera = makeCamera(rig_.cameras[0]);
  int far = 0, count = 0;
  while (auto frame = simulation.next()) {
    const Rigid3 world_from_camera = frame->truth.motion.world_from_body * rig_.cameras[0].body_from_camera;
    for (const FeatureObservation& o : frame->tracks.observations) {
      if (o.camera != 0) continue;
      far += (*camera->project(world_from_camera.inverse() * simulation.landmark(o.track)) - o.pixel).norm() >
             3.0;
      ++count;
    }
  }
  EXPECT_NEAR(static_cast<double>(far) / count, 0.05, 0.005);
}

TEST_F(PointSimulationTest, SameSeedSameFrames) {
  options_.end_s = 5.0;
  const auto a = run();
  const auto b = run();
  options_.seed = 2;
  const auto c = run();
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(a.back().tracks.observations.back().pixel, b.back().tracks.observations.back().pixel);
  EXPECT_EQ(a.back().imu.back().specific_force_B, b.back().imu.back().specific_force_B);
  EXPECT_NE(a.back().tracks.observations.back().pixel, c.back().tracks.observations.back().pixel);
}

}  // namespace
}  // namespace lodeline

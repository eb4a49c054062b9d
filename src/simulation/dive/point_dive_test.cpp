#include "simulation/dive/point_dive.h"

#include <gtest/gtest.h>

#include <chrono>

namespace lodeline {
namespace {

TEST(PointDive, TwentyMinutesTakeSecondsAndStayFullOfTracks) {
  DiveMotionOptions motion;
  motion.duration_s = 1200.0;
  motion.path_length_m = 300.0;
  const ImuErrors imu = drawImuErrors(imuGrade("gx5-25"), {}, 1);
  const auto begin = std::chrono::steady_clock::now();
  const PointDive dive = makePointDive(motion, standardRig({}), imu);
  PointSimulationOptions options;
  options.imu = imu;
  options.frame_rate_hz = 15.0;
  PointSimulation simulation = dive.simulate(options);
  int frames = 0;
  size_t fewest = 1000;
  while (auto frame = simulation.next()) {
    ++frames;
    fewest = std::min(fewest, frame->tracks.observations.size());
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  RecordProperty("seconds", std::to_string(seconds));
  EXPECT_EQ(frames, 1199 * 15 + 1);
  EXPECT_GE(fewest, 200u);
  EXPECT_EQ(dive.mounted.rig.imu.noise.gyroscope_density_rad_per_s_sqrtHz, imu.gyroscope.noise_density);
}

}  // namespace
}  // namespace lodeline

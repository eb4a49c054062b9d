#include "lodeline/inspection/clock_monitor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

Vec3 swayRate(double t_s) {
  return {0.3 * std::sin(1.7 * t_s), 0.25 * std::sin(2.3 * t_s + 1.0), 0.35 * std::sin(1.1 * t_s + 2.0)};
}

/// A rig that rotates without translation among points, observed at 20 Hz, with a gyroscope at 200 Hz.
class ClockMonitorTest : public testing::Test {
 protected:
  ClockMonitorTest() {
    rig_.cameras.emplace_back();
    rig_.cameras.front().name = "cam0";
    rig_.cameras.front().body_from_camera.rotation =
        Eigen::AngleAxisd(1.2, Vec3(0.3, -0.8, 0.5).normalized());
    std::uniform_real_distribution<double> anywhere(-0.6, 0.6);
    for (int i = 0; i < 150; ++i)
      points_.push_back(Vec3(anywhere(random_), anywhere(random_), 1.0).normalized());
  }

  /// Runs for the given seconds; the images' stamps are late by `delay_s` of their time.
  void run(double seconds, const std::function<double(double)>& delay_s, double turning = 1.0) {
    ClockMonitor monitor(rig_);
    std::normal_distribution<double> noise(0.0, 5e-4);
    Quat world_from_body = Quat::Identity();
    const Quat& body_from_camera = rig_.cameras.front().body_from_camera.rotation;
    std::vector<ImuSample> imu;
    for (int i = 0; i < static_cast<int>(200 * seconds); ++i) {
      const double t_s = 0.005 * i;
      imu.push_back(
          {Time::fromSeconds(t_s), turning * swayRate(t_s) + Vec3(0.02, -0.01, 0.03), Vec3::UnitZ()});
      world_from_body = world_from_body * so3::exp(turning * 0.005 * swayRate(t_s + 0.0025));
      if (i % 10 != 0) continue;
      FrameTracks tracks;
      tracks.time = Time::fromSeconds(t_s + 0.005 + delay_s(t_s));
      for (size_t k = 0; k < points_.size(); ++k) {
        const Vec3 ray =
            body_from_camera.conjugate() * (world_from_body.conjugate() * (body_from_camera * points_[k]));
        FeatureObservation seen;
        seen.track = static_cast<TrackId>(k);
        seen.bearing_C = (ray + Vec3(noise(random_), noise(random_), noise(random_))).normalized();
        tracks.observations.push_back(seen);
      }
      monitor.add(tracks, imu, &diagnostics_);
      imu.clear();
    }
  }

  std::mt19937 random_{5};
  Rig rig_;
  std::vector<Vec3> points_;
  Diagnostics diagnostics_;
};

TEST_F(ClockMonitorTest, SaysNothingOfClocksThatKeepTogether) {
  run(40.0, [](double) { return 0.0; });
  run(40.0, [](double) { return 0.004; });
  run(
      40.0, [](double) { return 0.2; }, 0.01);  // a rig that hardly rotates gives no comparison
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(ClockMonitorTest, NamesAnOffsetWithSignAndSize) {
  for (const double delay_s : {0.05, -0.02, 0.3}) {
    diagnostics_ = {};
    run(15.0, [=](double) { return delay_s; });
    ASSERT_EQ(diagnostics_.count("camera_time_offset"), 1) << delay_s;
    const std::string message = diagnostics_.ranked()[0].first_message;
    const std::string way = delay_s > 0.0 ? "lag behind the gyroscope by " : "run ahead of the gyroscope by ";
    EXPECT_THAT(message,
                testing::HasSubstr(way + std::to_string(static_cast<int>(std::abs(1000 * delay_s)))));
  }
}

TEST_F(ClockMonitorTest, NamesAJumpInMidRun) {
  run(30.0, [](double t_s) { return t_s < 15.0 ? 0.0 : 0.05; });
  EXPECT_EQ(diagnostics_.count("camera_time_offset"), 1);
  EXPECT_EQ(diagnostics_.count("camera_clock_jump"), 0);
  diagnostics_ = {};
  run(30.0, [](double t_s) { return t_s < 15.0 ? 0.05 : -0.05; });
  EXPECT_EQ(diagnostics_.count("camera_time_offset"), 1);
  EXPECT_EQ(diagnostics_.count("camera_clock_jump"), 1);
}

}  // namespace
}  // namespace lodeline

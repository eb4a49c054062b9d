#include "lodeline/estimator/zero_velocity/stationary_detector.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/estimator/trials/scene.h"
#include "lodeline/estimator/trials/test_window.h"

namespace lodeline {
namespace {

TestSceneOptions ofOneCamera() {
  TestSceneOptions options;
  options.cameras = 1;
  options.duration_s = 8.0;
  options.liveliness = 0.0;
  options.points.frame_rate_hz = 10.0;
  options.points.tracks = 60;
  options.points.longest_track_s = 100.0;
  return options;
}

/// Times of zero-velocity updates, s; `shake_m_per_s2` is added to the accelerometer's readings.
std::vector<double> rests(const TestSceneOptions& scene_options, double shake_m_per_s2 = 0.0,
                          const RestOptions& options = {}) {
  TestScene scene(scene_options);
  StationaryDetector watch(scene.rig(), options);
  std::vector<double> times_s;
  while (auto frame = scene.next()) {
    for (ImuSample& sample : frame->imu)
      sample.specific_force_B.z() += shake_m_per_s2 * std::sin(20.0 * scene.secondsOf(sample.time));
    const double time_s = scene.secondsOf(frame->tracks.time);
    if (watch.add(frame->tracks, frame->imu)) times_s.push_back(time_s);
  }
  return times_s;
}

TEST(StationaryDetector, SaysSoOnceASecondAtRest) {
  const std::vector<double> times_s = rests(ofOneCamera());
  ASSERT_GE(times_s.size(), 5U);
  EXPECT_GE(times_s.front(), 1.0);
  for (size_t i = 1; i < times_s.size(); ++i) EXPECT_GE(times_s[i] - times_s[i - 1], 1.0);
}

TEST(StationaryDetector, DoesNotTakeAGlideForRest) {
  // A constant velocity, which the readings do not show.
  TestSceneOptions options = ofOneCamera();
  options.drift_m_per_s = Vec3(0.0, 0.04, 0.0);
  EXPECT_TRUE(rests(options).empty());
  options.drift_m_per_s = Vec3(0.0, 0.0, 0.04);
  EXPECT_TRUE(rests(options).empty());
}

TEST(StationaryDetector, DoesNotTakeSwayingOrTurningForRest) {
  TestSceneOptions options = ofOneCamera();
  options.liveliness = 0.3;
  EXPECT_TRUE(rests(options).empty());
  options.translation = 0.0;
  EXPECT_TRUE(rests(options).empty());
}

TEST(StationaryDetector, BelievesNeitherReadingsNorImagesAlone) {
  TestSceneOptions options = ofOneCamera();
  EXPECT_TRUE(rests(options, 1.0).empty());
  options.points.blackouts = {{0.0, 20.0}};
  EXPECT_TRUE(rests(options).empty());
  EXPECT_TRUE(rests(ofOneCamera(), 0.0, {.enabled = false}).empty());
}

TEST(StationaryDetector, BeginsAnewWhereTheImagesWereGone) {
  TestSceneOptions options = ofOneCamera();
  options.points.blackouts = {{3.0, 2.0}};
  const std::vector<double> times_s = rests(options);
  ASSERT_GE(times_s.size(), 3U);
  for (const double time_s : times_s) EXPECT_TRUE(time_s < 3.0 || time_s > 5.99) << time_s;
}

TEST(StationaryDetector, LearnsTheGyroscopesBiasFromAllRests) {
  double squares = 0.0;
  constexpr int kSeeds = 20;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    TestSceneOptions options = ofOneCamera();
    options.seed = seed;
    TestScene scene(options);
    StationaryDetector watch(scene.rig(), {});
    double sigma_after_one = 0.0;
    Vec3 bias_B = Vec3::Zero();
    while (auto frame = scene.next()) {
      const bool rests = watch.add(frame->tracks, frame->imu);
      EXPECT_EQ(watch.gyroscope().has_value(), rests || sigma_after_one > 0.0);
      if (rests && sigma_after_one == 0.0) sigma_after_one = watch.gyroscope()->sigma_rad_per_s;
      bias_B = frame->truth.gyroscope_bias_B;
    }
    const GyroscopeAtRest found = *watch.gyroscope();
    EXPECT_LT(found.sigma_rad_per_s, 0.6 * sigma_after_one);
    squares += ((found.bias_B - bias_B) / found.sigma_rad_per_s).squaredNorm();
  }
  // The sigma includes the Earth's rotation and undetected motion, which do not occur here.
  EXPECT_LT(squares / (3 * kSeeds), 1.5);
  EXPECT_GT(squares / (3 * kSeeds), 0.05);
}

TEST(StationaryDetector, LearnsNothingWhereNothingRests) {
  TestSceneOptions options = ofOneCamera();
  options.liveliness = 0.3;
  TestScene scene(options);
  StationaryDetector watch(scene.rig(), {});
  while (auto frame = scene.next()) watch.add(frame->tracks, frame->imu);
  EXPECT_FALSE(watch.gyroscope());
}

TEST(RestFactor, HoldsTheVelocityAndNothingElse) {
  TestWindow test;
  Frame& frame = test.add(Rigid3(), false);
  EXPECT_FALSE(test.factors.rest(frame));
  frame.rest_sigma_m_per_s = 0.03;
  const auto costAt = [&](const Vec3& velocity_W, double bias) {
    frame.motion.fill(bias);
    Eigen::Map<Vec3>(frame.motion.data()) = velocity_W;
    std::vector<double> residual;
    return costOf(*test.factors.rest(frame), residual);
  };
  EXPECT_DOUBLE_EQ(costAt(Vec3::Zero(), 0.0), 0.0);
  EXPECT_DOUBLE_EQ(costAt(Vec3::Zero(), 0.7), 0.0);
  // Two sigmas in every direction: the cost contains no information about north.
  EXPECT_NEAR(costAt(Vec3(0.06, 0.0, 0.0), 0.0), 2.0, 1e-12);
  EXPECT_NEAR(costAt(Vec3(0.0, -0.06, 0.0), 0.0), 2.0, 1e-12);
  EXPECT_NEAR(costAt(0.06 * Vec3(1.0, 2.0, -2.0) / 3.0, 0.0), 2.0, 1e-12);
}

}  // namespace
}  // namespace lodeline

#include "lodeline/estimator/initialization/mono_initializer.h"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/estimator/trials/consistency.h"
#include "lodeline/estimator/trials/scene.h"

namespace lodeline {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TestSceneOptions monoScene(double duration_s) {
  TestSceneOptions options;
  options.cameras = 1;
  options.duration_s = duration_s;
  options.points.tracks = 100;
  options.points.frame_rate_hz = 12.5;
  return options;
}

// Runs until the frame that completes the initialization, or the end of the scene.
std::vector<Comparison> untilStarted(const TestSceneOptions& options) {
  TestScene scene(options);
  ComparedEstimator estimator(scene, honestOptions(options));
  std::vector<Comparison> comparisons;
  while (const auto frame = scene.next()) {
    comparisons.push_back(estimator.add(*frame));
    if (comparisons.back().initialized()) break;
    EXPECT_FALSE(comparisons.back().estimate.waiting_for.empty());
  }
  return comparisons;
}

void expectSoundStart(const TestSceneOptions& options, double max_rotation_error_rad = 0.05) {
  const std::vector<Comparison> comparisons = untilStarted(options);
  EXPECT_THAT(comparisons.front().estimate.waiting_for, StartsWith("frames 1 of 6"));
  ASSERT_TRUE(comparisons.back().initialized()) << comparisons.back().estimate.waiting_for;
  // The initialization guarantees a scale sigma of a tenth; an error of three sigmas is practically excluded.
  const Comparison& start = comparisons.back();
  const double way_m = start.true_world_from_body.translation.norm();
  EXPECT_GT(way_m, 0.1);
  EXPECT_NEAR(start.estimate.state.world_from_body.translation.norm() / way_m, 1.0, 0.3);
  // Relative to gravity and the first frame: an unknown accelerometer bias of 0.1 m/s^2 is 0.01 rad.
  EXPECT_LT(start.rotationError(), max_rotation_error_rad);
  EXPECT_LT(start.positionError(), 4.0 * std::sqrt(start.estimate.covariance.topLeftCorner<3, 3>().trace()));
}

TEST(MonoInitializer, StartsAMovingCameraAndSaysWhatItWaitsFor) {
  for (const uint64_t seed : {1, 2, 3}) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    TestSceneOptions options = monoScene(8.0);
    options.seed = seed;
    expectSoundStart(options);
  }
}

// Walls with little texture in milky water.
TEST(MonoInitializer, StartsWithFewTracks) {
  for (const uint64_t seed : {1, 2, 3}) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    TestSceneOptions options = monoScene(8.0);
    options.seed = seed;
    options.points.tracks = 35;
    expectSoundStart(options);
  }
}

// A consumer IMU carried by a calm swimmer: its bias is much larger than the accelerations. Starting from a
// zero bias, seed 1 ends in a false minimum with a velocity error of a third.
TEST(MonoInitializer, StartsWithAnAccelerometerThatIsFarOff) {
  for (const uint64_t seed : {1, 2, 3, 4}) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    TestSceneOptions options = monoScene(8.0);
    options.seed = seed;
    options.liveliness = 0.3;
    options.still = {{-20.0, 25.0}};
    options.accelerometer_bias_sigma_m_per_s2 = 0.3;
    expectSoundStart(options, 0.1);
  }
}

TEST(MonoInitializer, WaitsForParallaxWhileTheRigStandsStill) {
  TestSceneOptions options = monoScene(6.0);
  options.liveliness = 0.0;
  const std::vector<Comparison> comparisons = untilStarted(options);
  EXPECT_FALSE(comparisons.back().initialized());
  EXPECT_THAT(comparisons.back().estimate.waiting_for, StartsWith("parallax"));
  EXPECT_THAT(comparisons.back().estimate.waiting_for, HasSubstr("of 5 px"));
}

TEST(MonoInitializer, WaitsForParallaxWhileTheRigOnlyTurns) {
  TestSceneOptions options = monoScene(6.0);
  options.translation = 0.0;
  const std::vector<Comparison> comparisons = untilStarted(options);
  EXPECT_FALSE(comparisons.back().initialized());
  EXPECT_THAT(comparisons.back().estimate.waiting_for,
              testing::AnyOf(StartsWith("parallax"), StartsWith("frames")));
}

TEST(MonoInitializer, DoesNotGuessTheScaleOfASteadyGlide) {
  for (const uint64_t seed : {1, 2, 3}) {
    TestSceneOptions options = monoScene(5.0);
    options.seed = seed;
    options.liveliness = 0.0;
    options.drift_m_per_s = Vec3(0.1, 0.5, 0.1);
    const std::vector<Comparison> comparisons = untilStarted(options);
    EXPECT_FALSE(comparisons.back().initialized()) << "seed " << seed;
    EXPECT_THAT(comparisons.back().estimate.waiting_for, testing::Not(StartsWith("frames")))
        << "there was enough to see";
  }
}

/// Ten seconds after a resting rig has started to move: mean square of the position error, and mean NEES of
/// the pose. The base on which it rested turned at `turning_rad_per_s`, with everything in view.
struct AfterRest {
  double squared_error_m2 = 0.0, nees = 0.0;
};
AfterRest afterRest(int seeds, bool is_watched, double turning_rad_per_s = 0.0) {
  AfterRest mean;
  for (int seed = 1; seed <= seeds; ++seed) {
    TestSceneOptions options = monoScene(18.0);
    options.seed = static_cast<uint64_t>(seed);
    options.liveliness = 0.3;
    options.still = {{-20.0, 28.0}};
    EstimatorOptions estimator_options = honestOptions(options);
    estimator_options.rest.enabled = is_watched;
    TestScene scene(options);
    ComparedEstimator estimator(scene, estimator_options);
    Comparison last;
    while (auto frame = scene.next()) {
      for (ImuSample& sample : frame->imu) {
        if (scene.secondsOf(sample.time) < 4.0) sample.angular_velocity_B.z() += turning_rad_per_s;
      }
      last = estimator.add(*frame);
    }
    EXPECT_TRUE(last.initialized()) << seed;
    const Eigen::Matrix<double, 6, 6> covariance = last.estimate.covariance.topLeftCorner<6, 6>();
    mean.squared_error_m2 += last.error.head<3>().squaredNorm() / seeds;
    mean.nees += last.error.dot(covariance.inverse() * last.error) / seeds;
  }
  return mean;
}

// Image information on the gyroscope at rest must outlive the window of the start.
TEST(MonoInitializer, StartsWellWhereTheRigHasRested) {
  constexpr int kSeeds = 6;
  for (const bool is_watched : {true, false}) {
    const AfterRest mean = afterRest(kSeeds, is_watched);
    EXPECT_LT(std::sqrt(mean.squared_error_m2), 0.012) << is_watched;
    EXPECT_LT(mean.nees, neesBounds(6, kSeeds).high) << is_watched;
  }
}

TEST(MonoInitializer, IsNotMisledByARestOnWhatTurns) {
  // About twice the error of an initialization without any rest.
  EXPECT_LT(std::sqrt(afterRest(3, true, 0.05).squared_error_m2), 0.35);
}

}  // namespace
}  // namespace lodeline

#include "lodeline/estimator/trials/dive_consistency.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {

TEST(NeesBounds, AreThoseOfTheChiSquaredDistribution) {
  // Tables: chi-squared of 100 degrees of freedom at 0.0005 and 0.9995 is 59.90 and 153.17.
  const NeesBounds bounds = neesBounds(5, 20);
  EXPECT_NEAR(bounds.low, 59.90 / 20.0, 0.01);
  EXPECT_NEAR(bounds.high, 153.17 / 20.0, 0.01);
}

// The first metres of motion, in which only linearization points keep the heading covariance consistent. The
// robust loss reduces the weight of good observations to 0.7, so that the estimator's sigmas are about 1.2
// times too large. The lower bound is therefore half of that for an exact covariance.
void expectConsistent(int cameras) {
  ConsistencyOptions options;
  options.scene.cameras = cameras;
  options.scene.points.tracks = 50;
  options.scene.points.frame_rate_hz = 10.0;
  options.estimator = honestOptions(options.scene);
  // The scene's cameras match their files. An estimator that does not trust the files would add errors of the
  // intrinsics that do not occur here (covariance_inflation.h).
  options.estimator.camera_calibration.enabled = false;
  options.seeds = 12;
  options.times_s = {8.0};
  const Consistency consistency = measureConsistency(options);
  EXPECT_EQ(consistency.lost, 0);
  const ConsistencyRow& row = consistency.rows.back();
  const int count = static_cast<int>(row.samples.size());
  const auto expectWithin = [&](const char* name, int coordinates, double NeesSample::*figure) {
    const NeesBounds bounds = neesBounds(coordinates, count);
    EXPECT_LT(row.mean(figure), bounds.high) << name << " is worse than claimed";
    EXPECT_GT(row.mean(figure), 0.5 * bounds.low) << name << " is much better than claimed";
  };
  expectWithin("pose", 6, &NeesSample::pose);
  expectWithin("position", 3, &NeesSample::position);
  expectWithin("orientation", 3, &NeesSample::orientation);
  expectWithin("yaw", 1, &NeesSample::yaw);
  expectWithin("motion", 9, &NeesSample::motion);
}

TEST(Consistency, StereoIsAsGoodAsItSays) { expectConsistent(2); }
TEST(Consistency, MonoIsAsGoodAsItSays) { expectConsistent(1); }

// One camera without images for six seconds, in which its carrier comes to rest. Then there are images again,
// rest for six more seconds, and motion. Neither the velocity from dead reckoning nor the first images from
// almost one place determine the scale, and neither may be used for it. Without the zero-velocity update the
// estimate would glide on by 0.9 m past points that it takes for infinitely far.
TEST(Consistency, OneCameraInTheDarkNoticesThatItRests) {
  constexpr double kDark_s = 7.0, kLight_s = 13.0, kOn_s = 19.0;
  ConsistencyOptions options;
  options.scene.cameras = 1;
  options.scene.liveliness = 0.3;
  options.scene.still = {{kDark_s, kOn_s - kDark_s}};
  options.scene.points.blackouts = {{kDark_s, kLight_s - kDark_s}};
  options.scene.points.tracks = 90;
  options.scene.points.frame_rate_hz = 10.0;
  options.scene.points.longest_track_s = 100.0;
  options.estimator = honestOptions(options.scene);
  options.seeds = 12;
  options.times_s = {kLight_s + 3.0, kOn_s + 2.0};
  const Consistency consistency = measureConsistency(options);
  EXPECT_EQ(consistency.lost, 0);
  for (const ConsistencyRow& row : consistency.rows) {
    const int count = static_cast<int>(row.samples.size());
    EXPECT_LT(row.mean(&NeesSample::pose), neesBounds(6, count).high) << "at " << row.time_s << " s";
    EXPECT_LT(row.mean(&NeesSample::velocity), neesBounds(3, count).high) << "at " << row.time_s << " s";
  }
  EXPECT_LT(consistency.rows.front().rootMeanSquare(&NeesSample::position_error_m), 0.25);
}

// The short version of `estimator_consistency --minutes 20`.
TEST(Consistency, NoBlockOfADiveIsWorseThanClaimed) {
  DiveConsistencyOptions options;
  options.dive = exactDive(45.0);
  options.seeds = 8;
  options.times_s = {20.0, 44.0};
  const Consistency consistency = measureDiveConsistency(options);
  EXPECT_EQ(consistency.lost, 0);
  for (const ConsistencyRow& row : consistency.rows) {
    const NeesBounds bounds = neesBounds(3, options.seeds);
    for (const auto figure : {&NeesSample::position, &NeesSample::orientation, &NeesSample::velocity,
                              &NeesSample::gyroscope_bias, &NeesSample::accelerometer_bias}) {
      EXPECT_LT(row.mean(figure), bounds.high) << "at " << row.time_s << " s";
      EXPECT_GT(row.mean(figure), 0.5 * bounds.low) << "at " << row.time_s << " s";
    }
  }
}

TEST(Consistency, DivesDoNotDependOnTheNumberOfThreads) {
  DiveConsistencyOptions options;
  options.dive = exactDive(40.0);
  options.seeds = 3;
  options.times_s = {11.0};
  const Consistency alone = measureDiveConsistency(options);
  options.threads = 2;
  const Consistency together = measureDiveConsistency(options);
  ASSERT_EQ(together.rows[0].samples.size(), alone.rows[0].samples.size());
  for (size_t i = 0; i < alone.rows[0].samples.size(); ++i)
    EXPECT_EQ(together.rows[0].samples[i].pose, alone.rows[0].samples[i].pose);
}

}  // namespace
}  // namespace lodeline

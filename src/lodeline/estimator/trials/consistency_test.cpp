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

// The first metres of a heading that only linearization points keep honest. The robust loss counts good
// observations as 0.7 of their worth, which makes the estimator's sigmas some 1.2 times too large: hence the
// lower bound at half of what an exact covariance would give.
void expectConsistent(int cameras) {
  ConsistencyOptions options;
  options.scene.cameras = cameras;
  options.scene.points.tracks = 50;
  options.scene.points.frame_rate_hz = 10.0;
  options.estimator = honestOptions(options.scene);
  // The scene's cameras are what their files say; an estimator that doubts them claims errors of lenses which
  // do not happen here (covariance_inflation.h).
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

// One camera without images for six seconds in which its carrier comes to rest, then images again, rest for
// six more seconds, and on. Neither the speed that dead reckoning leaves nor the first look from almost one
// place tells the scale, and neither may be taken for it.
// Without the rest being noticed it glides on past points that it takes for infinitely far: by 0.9 m.
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

// The short version of what estimator_consistency --minutes 20 measures.
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

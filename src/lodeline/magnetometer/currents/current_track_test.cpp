#include "lodeline/magnetometer/currents/current_track.h"

#include <gtest/gtest.h>

#include <limits>

namespace lodeline {
namespace {

Time at(double time_s) { return Time::fromNanoseconds(0) + Duration::fromSeconds(100.0 + time_s); }

CurrentTrack ramp() {
  CurrentTrack track(2, 0.5);
  for (int i = 0; i <= 10; ++i) track.add({at(0.1 * i), {1.0 * i, -2.0}});
  return track;
}

TEST(CurrentTrack, IsLinearBetweenReadings) {
  const auto now = ramp().at(at(0.43));
  ASSERT_TRUE(now.has_value());
  EXPECT_NEAR(now->currents_A[0], 4.3, 1e-6);
  EXPECT_NEAR(now->currents_A[1], -2.0, 1e-12);
  EXPECT_TRUE(now->isMeasured());
  EXPECT_TRUE(ramp().at(at(1.0))->isMeasured()) << "at the newest reading";
}

TEST(CurrentTrack, HoldsTheNewestReadingWithTheUsualChangeAsSigma) {
  const auto now = ramp().at(at(1.05));
  ASSERT_TRUE(now.has_value());
  EXPECT_NEAR(now->currents_A[0], 10.0, 1e-9);
  EXPECT_NEAR(now->sigmas_A[0], 0.5, 1e-6);
  EXPECT_EQ(now->sigmas_A[1], 0.0);
  EXPECT_FALSE(ramp().at(at(1.6)).has_value()) << "longer than a gap";
}

TEST(CurrentTrack, KnowsNothingInGapsAndBeforeTheFirstReading) {
  CurrentTrack track = ramp();
  EXPECT_FALSE(track.at(at(-0.01)).has_value());
  track.add({at(2.0), {0.0, 0.0}});
  EXPECT_FALSE(track.at(at(1.5)).has_value());
  EXPECT_TRUE(track.at(at(2.1)).has_value());
}

TEST(CurrentTrack, RefusesReadingsOfAnotherKind) {
  CurrentTrack track = ramp();
  EXPECT_FALSE(track.add({at(1.1), {1.0}}));
  EXPECT_FALSE(track.add({at(1.1), {1.0, std::numeric_limits<double>::quiet_NaN()}}));
  EXPECT_FALSE(track.add({at(0.9), {1.0, 2.0}}));
  EXPECT_TRUE(track.add({at(1.1), {1.0, 2.0}}));
}

TEST(CurrentTrack, ForgetsNoReadingThatIsNeeded) {
  CurrentTrack track = ramp();
  track.forgetBefore(at(0.45));
  EXPECT_FALSE(track.at(at(0.35)).has_value());
  EXPECT_NEAR(track.at(at(0.45))->currents_A[0], 4.5, 1e-6);
}

}  // namespace
}  // namespace lodeline

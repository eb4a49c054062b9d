#include "lodeline/io/streams/stamp_bursts.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {

std::vector<Time> times(const std::vector<double>& seconds) {
  std::vector<Time> result;
  for (const double s : seconds) result.push_back(Time::fromSeconds(1.4e9) + Duration::fromSeconds(s));
  return result;
}

/// Stamps of a 200 Hz sensor that sends bursts of `size` readings; `within_s` is the step within a burst.
std::vector<Time> bursts(int size, double within_s, int count = 50, int first = 0) {
  std::vector<double> seconds;
  for (int i = first; i < first + count; ++i)
    seconds.push_back(0.005 * size * (i / size) + within_s * (i % size));
  return times(seconds);
}

TEST(StampBursts, GiveTheMeanPeriod) {
  for (const int size : {2, 5, 10, 12}) {
    for (const double within_s : {0.0, 1e-4}) {
      for (const int first : {0, 1, 3}) {
        const std::optional<Duration> period = burstPeriod(bursts(size, within_s, 50, first));
        ASSERT_TRUE(period) << size << " " << first;
        EXPECT_NEAR(period->seconds(), 0.005, 1e-4) << size << " " << first;
      }
    }
  }
}

TEST(StampBursts, AreNotSeenInSingleReadings) {
  std::vector<double> even, jittered, lossy, paused;
  for (int i = 0; i < 50; ++i) {
    even.push_back(0.005 * i);
    jittered.push_back(0.005 * i + 0.0024 * ((i * 7) % 5) / 4.0);
    if (i % 3 != 0) lossy.push_back(0.005 * i);
    paused.push_back(0.005 * i + (i > 20 ? 1.0 : 0.0) + (i > 30 ? 0.5 : 0.0));
  }
  for (const auto& stamps : {even, jittered, lossy, paused}) EXPECT_FALSE(burstPeriod(times(stamps)));
  EXPECT_FALSE(burstPeriod({}));
  EXPECT_FALSE(burstPeriod(times({1.0})));
  EXPECT_FALSE(burstPeriod(times({1.0, 1.0, 1.0})));
}

TEST(StampBursts, AreSpreadOutSinceTheBurstBefore) {
  BurstSpreader spreader(Duration::fromSeconds(0.005));
  EXPECT_EQ(spreader.spread(times({0.049, 0.05})), times({0.045, 0.05}));
  EXPECT_EQ(spreader.spread(times({0.07, 0.07, 0.07, 0.07})), times({0.055, 0.06, 0.065, 0.07}));
  EXPECT_TRUE(spreader.separates(times({0.07})[0], times({0.09})[0]));
  EXPECT_FALSE(spreader.separates(times({0.07})[0], times({0.0701})[0]));
  // After a pause of half a second, readings keep their period.
  EXPECT_EQ(spreader.spread(times({0.6, 0.6})), times({0.595, 0.6}));
}

}  // namespace
}  // namespace lodeline

#include "lodeline/io/streams/stream_rate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

std::vector<Time> everySoMany_ns(int64_t step_ns, int count = 50) {
  std::vector<Time> stamps;
  for (int i = 0; i < count; ++i)
    stamps.push_back(Time::fromNanoseconds(1'400'000'000'000'000'000 + step_ns * i));
  return stamps;
}

TEST(StreamRate, StatedRateStandsUnlessTheStampsContradict) {
  Diagnostics diagnostics;
  EXPECT_EQ(settleRate("IMU", everySoMany_ns(5'100'000), 200.0, &diagnostics), 200.0);
  EXPECT_TRUE(diagnostics.ranked().empty());
  EXPECT_NEAR(settleRate("IMU", everySoMany_ns(5'000'000), 400.0, &diagnostics), 200.0, 1e-9);
  EXPECT_EQ(diagnostics.count("rate"), 1);
}

TEST(StreamRate, BurstsHaveTheirMeanRate) {
  std::vector<Time> stamps;
  for (int i = 0; i < 50; ++i)
    stamps.push_back(Time::fromNanoseconds(50'000'000 * (i / 10) + 100'000 * (i % 10)));
  Diagnostics diagnostics;
  EXPECT_EQ(settleRate("IMU", stamps, 200.0, &diagnostics), 200.0);
  EXPECT_TRUE(diagnostics.ranked().empty());
}

TEST(StreamRate, StampsThatStandStillAreRefusedWithAdvice) {
  Diagnostics diagnostics;
  const std::vector<Time> zeros(50);
  EXPECT_THAT([&] { settleRate("/imu", zeros, 200.0, &diagnostics, "give --x"); },
              testing::ThrowsMessage<InputError>(
                  testing::AllOf(testing::HasSubstr("/imu: the first 50 readings all have the stamp 0 ns"),
                                 testing::HasSubstr("give --x"))));
}

TEST(StreamRate, StampsThatDescendAreRefused) {
  Diagnostics diagnostics;
  std::vector<Time> stamps = everySoMany_ns(-5'000'000);
  EXPECT_THAT([&] { refuseBadClock("gyroscope", stamps); },
              testing::ThrowsMessage<InputError>(testing::HasSubstr("gyroscope: the readings are stored in "
                                                                    "reverse order")));
  stamps[20] = stamps[19] + Duration::fromNanoseconds(1);
  EXPECT_NO_THROW(refuseBadClock("gyroscope", stamps));
  EXPECT_NO_THROW(refuseBadClock("gyroscope", everySoMany_ns(5'000'000)));
  EXPECT_NO_THROW(refuseBadClock("gyroscope", everySoMany_ns(-5'000'000, 9)));
}

TEST(StreamRate, AHundredTimesTheStatedOneIsAnotherUnit) {
  Diagnostics diagnostics;
  EXPECT_THAT([&] { settleRate("IMU", everySoMany_ns(50'000), 200.0, &diagnostics); },
              testing::ThrowsMessage<InputError>(
                  testing::AllOf(testing::HasSubstr("steps of 100 ns"), testing::HasSubstr("`t [100 ns]`"))));
  EXPECT_THAT([&] { settleRate("IMU", everySoMany_ns(5'000), 200.0, &diagnostics); },
              testing::ThrowsMessage<InputError>(testing::HasSubstr("count microseconds")));
  // A rate in the file that nobody filled in, and a fast sensor with a wrong rate.
  EXPECT_NEAR(settleRate("IMU", everySoMany_ns(5'000'000), 2.0, &diagnostics), 200.0, 1e-9);
  EXPECT_NEAR(settleRate("IMU", everySoMany_ns(250'000), 200.0, &diagnostics), 4000.0, 1e-9);
  EXPECT_EQ(diagnostics.count("rate"), 2);
}

std::vector<double> numbers(double first, double step) {
  std::vector<double> stamps;
  for (int i = 0; i < 50; ++i) stamps.push_back(first + step * i);
  return stamps;
}

TEST(StreamRate, StampsCountNanosecondsUnlessNoSensorIsThatFast) {
  EXPECT_EQ(unitOfNanosecondStamps(numbers(1.4e18, 5e6), kInertialRate), TimeUnit::Nanoseconds);
  EXPECT_EQ(unitOfNanosecondStamps(numbers(1.4e15, 5e3), kInertialRate), TimeUnit::Microseconds);
  EXPECT_EQ(unitOfNanosecondStamps(numbers(1.4e12, 5.0), kInertialRate), TimeUnit::Milliseconds);
  EXPECT_EQ(unitOfNanosecondStamps(numbers(1.4e15, 5e4), kCameraRate), TimeUnit::Microseconds);
  EXPECT_EQ(unitOfNanosecondStamps(numbers(134'247'456e9, 1e5), kInertialRate), TimeUnit::Ticks);
  EXPECT_EQ(unitOfNanosecondStamps(numbers(639'158'688e9, 5e5), kCameraRate), TimeUnit::Ticks);
  // Slow, fast and unknown streams of nanoseconds keep their unit.
  EXPECT_EQ(unitOfNanosecondStamps(numbers(0.0, 1e9), kInertialRate), TimeUnit::Nanoseconds);
  EXPECT_EQ(unitOfNanosecondStamps(numbers(0.0, 1e5), kInertialRate), TimeUnit::Nanoseconds);
  EXPECT_EQ(unitOfNanosecondStamps(numbers(0.0, 0.0), kInertialRate), TimeUnit::Nanoseconds);
}

}  // namespace
}  // namespace lodeline

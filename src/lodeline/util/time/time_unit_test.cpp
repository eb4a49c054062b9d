#include "lodeline/util/time/time_unit.h"

#include <gtest/gtest.h>

#include <limits>

namespace lodeline {
namespace {

TEST(TimeUnit, IsReadFromTheNameOfAColumn) {
  const auto is = [](const char* name, TimeUnit unit) { EXPECT_EQ(timeUnitOfName(name), unit) << name; };
  for (const char* name : {"#timestamp [ns]", "timestamp_ns", "time(nanoseconds)", "t_nsec", "TimeNS"})
    is(name, TimeUnit::Nanoseconds);
  for (const char* name : {"TimeUS", "time_usec", "t [\u00b5s]", "t (\u03bcs)", "timestamp [us]",
                           "timestampus", "timestamp_sample_us", "micros"})
    is(name, TimeUnit::Microseconds);
  for (const char* name :
       {"time_ms", "Time since start in ms ", "timeMs", "millis", "t [msec]", "time_boot_ms"})
    is(name, TimeUnit::Milliseconds);
  for (const char* name : {"t [s]", "Time (s)", "seconds_elapsed", "time_s", "Zeit / s", "header.stamp.secs",
                           "Sample Time (sec)"})
    is(name, TimeUnit::Seconds);
  is("Time (min)", TimeUnit::Minutes);
  is("hours", TimeUnit::Hours);
  is("seconds_elapsed [ms]", TimeUnit::Milliseconds);  // brackets have priority
}

TEST(TimeUnit, IsNotReadIntoNamesThatStateNone) {
  for (const char* name : {"t", "time", "timestamp", "Timestamp", "stamp", "times", "time [ticks]", "Minimum",
                           "", "date", "status", "sensor time"})
    EXPECT_EQ(timeUnitOfName(name), std::nullopt) << name;
}

std::vector<double> steps(double first, double step, int count = 40) {
  std::vector<double> stamps;
  for (int i = 0; i < count; ++i) stamps.push_back(first + step * i);
  return stamps;
}

TEST(TimeUnit, IsTheOneInWhichTheRateIsPlausible) {
  EXPECT_EQ(timeUnitOfStamps(steps(1.4e18, 5e6), kInertialRate), TimeUnit::Nanoseconds);
  EXPECT_EQ(timeUnitOfStamps(steps(987654, 10000), kInertialRate), TimeUnit::Microseconds);
  EXPECT_EQ(timeUnitOfStamps(steps(1523, 10), kInertialRate), TimeUnit::Milliseconds);
  EXPECT_EQ(timeUnitOfStamps(steps(1523, 1), kInertialRate), TimeUnit::Milliseconds);
  EXPECT_EQ(timeUnitOfStamps(steps(0.0, 0.01), kInertialRate), TimeUnit::Seconds);
  EXPECT_EQ(timeUnitOfStamps(steps(0.0, 10.0), kDepthRate), TimeUnit::Seconds);
  EXPECT_EQ(timeUnitOfStamps(steps(0.0, 1000.0), kDepthRate), TimeUnit::Milliseconds);
}

TEST(TimeUnit, OfTwoThatPassTakesTheSizeOfAUnixTime) {
  // 10 Hz in milliseconds, or 10 kHz in microseconds.
  EXPECT_EQ(timeUnitOfStamps(steps(1.7e12, 100.0), kInertialRate), TimeUnit::Milliseconds);
  EXPECT_EQ(timeUnitOfStamps(steps(1.7e15, 100.0), kInertialRate), TimeUnit::Microseconds);
}

// 2026-06-01 0:00 UTC in steps of 100 ns.
constexpr double kSince1601 = 134'247'456e9, kSinceYear1 = 639'158'688e9, kSince1970 = 17'802'720e9,
                 kSince1980 = 14'643'073e9;

TEST(TimeUnit, IsTicksWhereTheyAreACurrentTime) {
  for (const double first : {kSince1601, kSinceYear1, kSince1970, kSince1980}) {
    EXPECT_EQ(timeUnitOfStamps(steps(first, 50'000), kInertialRate), TimeUnit::Ticks) << first;
    EXPECT_TRUE(areTicks(steps(first, 50'000), kInertialRate)) << first;
    EXPECT_EQ(timeUnitOfStamps(steps(first, 500'000), kCameraRate), TimeUnit::Ticks) << first;
    EXPECT_TRUE(areTicks(steps(first, 500'000), kCameraRate)) << first;
  }
  EXPECT_TRUE(areTicks(steps(kSinceYear1, 10'000'000), kDepthRate));
  // No current time, and no sensor's rate.
  EXPECT_FALSE(areTicks(steps(987654, 50'000), kInertialRate));
  EXPECT_FALSE(areTicks(steps(kSince1601, 5e6), kInertialRate));
  EXPECT_FALSE(areTicks(steps(1.7e18, 5e6), kInertialRate));
  EXPECT_FALSE(areTicks({kSince1601}, kInertialRate));
  // Nanoseconds of a computer that runs for half a year.
  EXPECT_FALSE(areTicks(steps(1.6e16, 5e6), kInertialRate));
  EXPECT_FALSE(areTicks(steps(1.6e16, 1e6), kInertialRate));
}

TEST(TimeUnit, OfTicksHasTheEpochThatItsSizeTells) {
  EXPECT_EQ(parseTime_ns("134247456000000001", TimeUnit::Ticks), 1'780'272'000'000'000'100);
  EXPECT_EQ(parseTime_ns("639158688000000001", TimeUnit::Ticks), 1'780'272'000'000'000'100);
  EXPECT_EQ(parseTime_ns("17802720000000001", TimeUnit::Ticks), 1'780'272'000'000'000'100);
  EXPECT_EQ(parseTime_ns("-15", TimeUnit::Ticks), -1500);
  EXPECT_EQ(parseTime_ns("1.5e1", TimeUnit::Ticks), 1500);
  EXPECT_EQ(parseTime_ns("1.34247456e17", TimeUnit::Ticks), 1'780'272'000'000'000'000);
  EXPECT_EQ(parseTime_ns("92900000000000000", TimeUnit::Ticks), std::nullopt);  // beyond 64 bits
  for (const char* name : {"t [100 ns]", "time (100ns)", "timestamp_100ns", "GpsTime_100_ns"})
    EXPECT_EQ(timeUnitOfName(name), TimeUnit::Ticks) << name;
}

TEST(TimeUnit, IsUnknownWhereNoRateIsPlausible) {
  EXPECT_EQ(timeUnitOfStamps(steps(0.0, 0.0), kInertialRate), std::nullopt);
  EXPECT_EQ(timeUnitOfStamps(steps(0.0, 3600.0), kInertialRate), TimeUnit::Microseconds);
  EXPECT_EQ(timeUnitOfStamps(steps(0.0, 3600.0), kCameraRate), TimeUnit::Microseconds);
  EXPECT_EQ(timeUnitOfStamps(steps(0.0, 1e12), kInertialRate), std::nullopt);
  EXPECT_EQ(timeUnitOfStamps({1.0}, kInertialRate), std::nullopt);
}

TEST(TimeUnit, RateOfBurstsIsTheMeanRate) {
  std::vector<double> stamps;
  for (int burst = 0; burst < 10; ++burst)
    for (int i = 0; i < 10; ++i) stamps.push_back(0.05 * burst + 1e-4 * i);
  EXPECT_NEAR(stampsPerUnit(stamps), 200.0, 30.0);
  stamps[40] = 1e9;  // an isolated wrong stamp
  EXPECT_NEAR(stampsPerUnit(stamps), 200.0, 30.0);
}

TEST(TimeUnit, ParsesDecimalsToTheNanosecond) {
  EXPECT_EQ(parseTime_ns("1403636579.763555584", TimeUnit::Seconds), 1403636579763555584);
  EXPECT_EQ(parseTime_ns("1403636579763555584", TimeUnit::Nanoseconds), 1403636579763555584);
  EXPECT_EQ(parseTime_ns("-9.950000128", TimeUnit::Seconds), -9950000128);
  EXPECT_EQ(parseTime_ns("-0.5", TimeUnit::Seconds), -500000000);
  EXPECT_EQ(parseTime_ns("1523", TimeUnit::Milliseconds), 1523000000);
  EXPECT_EQ(parseTime_ns("1.7e3", TimeUnit::Milliseconds), 1700000000);
  EXPECT_EQ(parseTime_ns("0.00000000049", TimeUnit::Seconds), 0);
  EXPECT_EQ(parseTime_ns(".5", TimeUnit::Minutes), 30000000000);
  EXPECT_EQ(parseTime_ns("9223372036854775807", TimeUnit::Nanoseconds), std::numeric_limits<int64_t>::max());
  EXPECT_EQ(parseTime_ns("-9223372036854775808", TimeUnit::Nanoseconds), std::numeric_limits<int64_t>::min());
}

TEST(TimeUnit, RefusesWhatIsNoTime) {
  for (const char* text : {"", "-", ".", "1.2.3", "abc", "nan", "inf", "--1", "+-1", "1e30", "12 ", "0x10",
                           "9223372036854775808", "100000000000000000000000000000000000000000000"})
    EXPECT_EQ(parseTime_ns(text, TimeUnit::Nanoseconds), std::nullopt) << text;
  EXPECT_EQ(parseTime_ns("9223372036.9", TimeUnit::Seconds), std::nullopt);
}

}  // namespace
}  // namespace lodeline

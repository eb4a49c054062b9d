#include "lodeline/io/tables/time_columns.h"

#include <gtest/gtest.h>

#include <limits>

namespace lodeline {
namespace {

std::vector<TimeColumn> timesOf(std::initializer_list<const char*> names) {
  std::vector<ColumnName> columns;
  for (const char* name : names) columns.emplace_back(name);
  return findTimeColumns(columns);
}

TEST(TimeColumns, AreOrderedByWhatTheyAre) {
  const auto ros = timesOf({"time", "field.header.seq", "field.header.stamp"});
  ASSERT_EQ(ros.size(), 2u);
  EXPECT_EQ(ros[0].column, 2u);
  const auto phone = timesOf({"seconds_elapsed", "time"});
  ASSERT_EQ(phone.size(), 2u);
  EXPECT_EQ(phone[0].column, 1u);
  EXPECT_EQ(phone[1].unit, TimeUnit::Seconds);
  EXPECT_EQ(timesOf({"", "X (\u00b5T)", "t / s"}).front().column, 2u);
  EXPECT_TRUE(timesOf({"temperature", "x", "tilt"}).empty());
}

TEST(TimeColumns, AreNotTeslas) {
  EXPECT_TRUE(timesOf({"mag_x_uT", "mag y nT", "field_z_T"}).empty());
  EXPECT_EQ(timesOf({"imu_t", "T"}).size(), 2u);
}

TEST(TimeColumns, MayBeDatesAndTimesOfDay) {
  const auto stamp = timesOf({"timestamp", "mag_x_uT"});
  ASSERT_EQ(stamp.size(), 1u);
  const auto time_ns = [&](const char* cell) {
    return timeFrom_ns(stamp[0], TimeUnit::Nanoseconds, cell, "");
  };
  EXPECT_EQ(time_ns("2026-11-21T12:00:00.123456789Z"), 1795262400123456789);
  EXPECT_EQ(time_ns("2026-11-21T12:00:00+02:00"), 1795255200000000000);
  EXPECT_EQ(time_ns("21-Nov-2026 12:00:00.250"), 1795262400250000000);
  EXPECT_EQ(time_ns("12:00:00,25"), 43200250000000);
  for (const char* text : {"21-Foo-2026", "2026-13-01", "99999-01-01", "1:2:3:4", "today"}) {
    EXPECT_EQ(time_ns(text), std::nullopt) << text;
  }
}

TEST(TimeColumns, HaveSecondParts) {
  const auto bare = timesOf({"sec", "nanosec", "x"});
  ASSERT_EQ(bare.size(), 1u);
  EXPECT_EQ(timeFrom_ns(bare[0], *bare[0].unit, "1700000000", "5"), 1700000000000000005);
  const auto secs = timesOf({"header.stamp.secs", "header.stamp.nsecs"});
  ASSERT_EQ(secs.size(), 1u);
  EXPECT_EQ(timeFrom_ns(secs[0], *secs[0].unit, "1700000000", "5"), 1700000000000000005);
  EXPECT_EQ(timeFrom_ns(secs[0], *secs[0].unit, "1700000000", "x"), std::nullopt);
  const auto gps = timesOf({"GPS Week", "GPS TOW"});
  ASSERT_EQ(gps.size(), 1u);
  EXPECT_EQ(timeFrom_ns(gps[0], *gps[0].unit, "0.5", "1"), 604800500000000);
  EXPECT_EQ(timeFrom_ns(gps[0], *gps[0].unit, "0.5", "99999999999"), std::nullopt);
  const auto xsens = timesOf({"PacketCounter", "SampleTimeFine"});
  ASSERT_EQ(xsens.size(), 1u);
  EXPECT_EQ(timeFrom_ns(xsens[0], *xsens[0].unit, "100", ""), 10'000'000);
}

}  // namespace
}  // namespace lodeline

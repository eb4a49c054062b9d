#include "lodeline/io/streams/time_span.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace lodeline {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TimeSpan between(double first_s, double last_s) {
  return {Time::fromSeconds(first_s), Time::fromSeconds(last_s)};
}

TEST(TimeSpans, ThatMeetAreNotApart) {
  EXPECT_FALSE(apart("a", between(0, 10), "b", between(5, 15), "x"));
  EXPECT_FALSE(apart("a", between(5, 15), "b", between(0, 10), "x"));
  EXPECT_FALSE(apart("a", between(0, 10), "b", between(10, 15), "x"));
  EXPECT_FALSE(apart("a", between(2, 3), "b", between(0, 10), "x"));
}

TEST(TimeSpans, ThatDoNotMeetAreNamedWithBothSpans) {
  const auto earlier = apart("images", between(100, 110), "IMU", between(0, 10), "timeshift");
  ASSERT_TRUE(earlier);
  EXPECT_THAT(
      *earlier,
      AllOf(HasSubstr("images from 100000000000 to 110000000000 ns"),
            HasSubstr("IMU from 0 to 10000000000 ns, which is 90 s earlier (100 s from first to first)"),
            HasSubstr("set timeshift")));
  EXPECT_THAT(*apart("images", between(0, 10), "IMU", between(100, 110), "x"), HasSubstr("90 s later"));
}

TEST(TimeSpans, OfDamagedStampsDoNotOverflow) {
  const Time least = Time::fromNanoseconds(std::numeric_limits<int64_t>::min());
  const Time most = Time::fromNanoseconds(std::numeric_limits<int64_t>::max());
  EXPECT_THAT(*apart("a", {least, least}, "b", {most, most}, "x"), HasSubstr("9.22337e+09 s later"));
}

TEST(TimeSpans, AreGatheredInAnyOrder) {
  SpanOfStream stream;
  EXPECT_FALSE(stream.get());
  for (const double s : {3.0, 1.0, 2.0}) stream.add(Time::fromSeconds(s));
  EXPECT_EQ(stream.get()->first, Time::fromSeconds(1.0));
  EXPECT_EQ(stream.get()->last, Time::fromSeconds(3.0));
}

}  // namespace
}  // namespace lodeline

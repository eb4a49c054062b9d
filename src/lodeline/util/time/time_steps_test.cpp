#include "lodeline/util/time/time_steps.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {

TEST(TimeSteps, PrintSecondsWithOneSignAndAllDigits) {
  const auto text = [](int64_t ns) { return secondsText(Time::fromNanoseconds(ns)); };
  EXPECT_EQ(text(1403636584763555584), "1403636584.763555584");
  EXPECT_EQ(text(-9950000128), "-9.950000128");
  EXPECT_EQ(text(-5), "-0.000000005");
  EXPECT_EQ(text(0), "0.000000000");
  EXPECT_EQ(text(std::numeric_limits<int64_t>::min()), "-9223372036.854775808");
}

TEST(TimeSteps, BetweenDamagedStampsSaturate) {
  const Time first = Time::fromNanoseconds(std::numeric_limits<int64_t>::min());
  const Time last = Time::fromNanoseconds(std::numeric_limits<int64_t>::max());
  EXPECT_EQ(span(last, first).nanoseconds(), std::numeric_limits<int64_t>::max());
  EXPECT_EQ(span(first, last).nanoseconds(), std::numeric_limits<int64_t>::min());
  EXPECT_EQ(span(last, last - Duration::fromNanoseconds(7)).nanoseconds(), 7);
  EXPECT_EQ(moved(last, Duration::fromNanoseconds(1)), last);
  EXPECT_EQ(moved(first, Duration::fromNanoseconds(-1)), first);
}

}  // namespace
}  // namespace lodeline

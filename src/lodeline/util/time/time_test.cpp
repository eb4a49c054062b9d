#include "lodeline/types.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {

TEST(Time, KeepsEveryNanosecondOfAUnixStamp) {
  const Time a = Time::fromNanoseconds(1403636584763555584);
  const Time b = Time::fromNanoseconds(1403636584763555585);
  EXPECT_LT(a, b);
  EXPECT_EQ((b - a).nanoseconds(), 1);
  EXPECT_EQ(a + (b - a), b);
}

TEST(Time, SecondsRoundToTheNearestNanosecond) {
  EXPECT_EQ(Duration::fromSeconds(0.1).nanoseconds(), 100000000);
  EXPECT_EQ(Duration::fromSeconds(-1e-9 * 1.6).nanoseconds(), -2);
  EXPECT_DOUBLE_EQ(Duration::fromSeconds(2.5).seconds(), 2.5);
}

}  // namespace
}  // namespace lodeline

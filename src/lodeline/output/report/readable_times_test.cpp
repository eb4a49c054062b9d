#include "lodeline/output/report/readable_times.h"

#include <gtest/gtest.h>

#include <limits>

namespace lodeline {
namespace {

TEST(ReadableTimes, ClockHasMinutesAndHours) {
  EXPECT_EQ(clockText(0.0), "0:00.0");
  EXPECT_EQ(clockText(16.44), "0:16.4");
  EXPECT_EQ(clockText(59.96), "1:00.0");
  EXPECT_EQ(clockText(3723.5), "1:02:03.5");
  EXPECT_EQ(clockText(-2.0), "-0:02.0");
}

TEST(ReadableTimes, StampsOfTheRecordingBecomeTimesSinceItsStart) {
  const Time origin = Time::fromNanoseconds(1403636580013555584);
  EXPECT_EQ(withReadableTimes("cam1: no image within 5 ms of stamp 1403636596413555584 ns", origin),
            "cam1: no image within 5 ms of stamp 0:16.400");
  EXPECT_EQ(withReadableTimes("from 1403636581013555584 ns to 1403636582013555584 ns", origin),
            "from 0:01.000 to 0:02.000");
}

TEST(ReadableTimes, OtherNumbersStay) {
  const Time origin = Time::fromNanoseconds(1403636580013555584);
  for (const char* message : {"a step of 12345 ns", "0.5 ns", "stamp 9223372036854775807 ns",
                              "stamp 99999999999999999999 ns", "field 48000 nT"}) {
    EXPECT_EQ(withReadableTimes(message, origin), message);
  }
  EXPECT_EQ(withReadableTimes("stamp 9223372036854775807 ns",
                              Time::fromNanoseconds(std::numeric_limits<int64_t>::min())),
            "stamp 9223372036854775807 ns");
}

}  // namespace
}  // namespace lodeline

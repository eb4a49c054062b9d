#include "lodeline/data/ordered_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "lodeline/sensors/measurements.h"

namespace lodeline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class OrderedStreamTest : public testing::Test {
 protected:
  /// Stamps, in ms, that come out of a 100 Hz stream when these go in.
  std::vector<int64_t> filter(const std::vector<int64_t>& stamps_ms, double offset_s = 0.0) {
    StreamExpectation expected{"depth", "the sensor", 100.0, 0.04, Duration::fromSeconds(offset_s)};
    size_t next = 0;
    OrderedStream<DepthSample> stream(
        expected,
        [&]() -> std::optional<DepthSample> {
          if (next == stamps_ms.size()) return std::nullopt;
          return DepthSample{Time::fromNanoseconds(stamps_ms[next++] * 1'000'000), 0.0};
        },
        &diagnostics_);
    std::vector<int64_t> passed_ms;
    while (stream.peek() != nullptr) passed_ms.push_back(stream.pop().time.nanoseconds() / 1'000'000);
    return passed_ms;
  }

  Diagnostics diagnostics_;
};

TEST_F(OrderedStreamTest, PassesOrderedStampsShiftedToTheImuClock) {
  EXPECT_THAT(filter({10, 20, 30}, 0.5), ElementsAre(510, 520, 530));
  EXPECT_TRUE(filter({}).empty());
  EXPECT_THAT(filter({5}), ElementsAre(5));
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(OrderedStreamTest, DropsDuplicatesAndNamesTheStamp) {
  EXPECT_THAT(filter({10, 20, 20, 20, 30}), ElementsAre(10, 20, 30));
  EXPECT_EQ(diagnostics_.count("depth_duplicate"), 2);
  EXPECT_THAT(diagnostics_.ranked()[0].first_message, HasSubstr("the sensor: stamp 20000000 ns"));
}

TEST_F(OrderedStreamTest, DropsWhatGoesBackwards) {
  EXPECT_THAT(filter({10, 20, 30, 15, 25, 40}), ElementsAre(10, 20, 30, 40));
  EXPECT_EQ(diagnostics_.count("depth_disorder"), 2);
  EXPECT_THAT(diagnostics_.ranked()[0].first_message, HasSubstr("from stamp 30000000 ns to 15000000 ns"));
}

TEST_F(OrderedStreamTest, OneWildStampDoesNotSilenceTheRest) {
  EXPECT_THAT(filter({10, 20, 999'000, 40, 50}), ElementsAre(10, 20, 40, 50));
  EXPECT_THAT(filter({999'000, 10, 20}), ElementsAre(10, 20));
}

TEST_F(OrderedStreamTest, ReportsGaps) {
  EXPECT_THAT(filter({10, 50, 550, 560}), ElementsAre(10, 50, 550, 560));
  EXPECT_EQ(diagnostics_.count("depth_gap"), 1);
  EXPECT_THAT(diagnostics_.ranked()[0].first_message,
              HasSubstr("nothing for 0.500 s after stamp 50000000 ns"));
}

}  // namespace
}  // namespace lodeline

#include "lodeline/io/streams/ordered_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/rig.h"

namespace lodeline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class OrderedStreamTest : public testing::Test {
 protected:
  /// Output stamps, in ms, of a 100 Hz stream for the given input stamps. `repeats`: equal stamps have equal
  /// depths; otherwise every reading has another depth.
  std::vector<int64_t> filter(const std::vector<int64_t>& stamps_ms, double offset_s = 0.0,
                              bool repeats = false) {
    OrderedStream<DepthSample> stream = streamOf(stamps_ms, offset_s, repeats);
    std::vector<int64_t> passed_ms;
    while (stream.peek() != nullptr) passed_ms.push_back(stream.pop().time.nanoseconds() / 1'000'000);
    return passed_ms;
  }

  OrderedStream<DepthSample> streamOf(const std::vector<int64_t>& stamps_ms, double offset_s, bool repeats) {
    StreamExpectation expected{"depth",    "the sensor", 100.0, 0.04, Duration::fromSeconds(offset_s),
                               look_ahead_};
    pulled_ = 0;
    const auto pull = [this, stamps_ms, repeats]() -> std::optional<DepthSample> {
      if (pulled_ == stamps_ms.size()) return std::nullopt;
      const int64_t stamp_ms = stamps_ms[pulled_++];
      const double depth_m = static_cast<double>(repeats ? stamp_ms : static_cast<int64_t>(pulled_));
      return DepthSample{Time::fromNanoseconds(stamp_ms * 1'000'000), depth_m};
    };
    return {expected, pull, &diagnostics_};
  }

  size_t pulled_ = 0, look_ahead_ = StreamExpectation().look_ahead;
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

TEST_F(OrderedStreamTest, PutsLateReadingsInTheirPlaces) {
  EXPECT_THAT(filter({10, 20, 30, 60, 50, 40, 70}), ElementsAre(10, 20, 30, 40, 50, 60, 70));
  EXPECT_EQ(diagnostics_.count("depth_disorder"), 2);
  EXPECT_THAT(diagnostics_.ranked()[0].first_message,
              HasSubstr("from stamp 60000000 ns to 50000000 ns; the latter is put in its place"));
  EXPECT_THAT(filter({30, 10, 20, 40}), ElementsAre(10, 20, 30, 40));
  // Eight readings of one packet arrived late.
  EXPECT_THAT(filter({10, 20, 60, 70, 80, 30, 40, 50, 90}), ElementsAre(10, 20, 30, 40, 50, 60, 70, 80, 90));
}

TEST_F(OrderedStreamTest, DropsWhatComesTooLate) {
  EXPECT_THAT(filter({10, 20, 30, 40, 15, 50}), ElementsAre(10, 20, 30, 40, 50));
  EXPECT_EQ(diagnostics_.count("depth_disorder"), 1);
  EXPECT_THAT(diagnostics_.ranked()[0].first_message, HasSubstr("to 15000000 ns; the latter is dropped"));
}

TEST_F(OrderedStreamTest, GoesOnWhereTheClockWasSetBack) {
  for (const int64_t back_ms : {20, 33, 100, 5'000, 3'600'000}) {
    std::vector<int64_t> stamps, expected;
    for (int i = 1; i <= 200; ++i) {
      expected.push_back(10 * i);
      stamps.push_back(10 * i - (i > 100 ? back_ms : 0));
    }
    diagnostics_ = {};
    EXPECT_EQ(filter(stamps), expected) << back_ms;
    EXPECT_EQ(diagnostics_.count("depth_clock_jump"), 1) << back_ms;
    EXPECT_EQ(diagnostics_.ranked().size(), 1u) << back_ms;
  }
}

TEST_F(OrderedStreamTest, GoesOnWhereTheClockWasSetBackTwice) {
  std::vector<int64_t> stamps, expected;
  for (int i = 1; i <= 300; ++i) {
    expected.push_back(10 * i);
    stamps.push_back(10 * i - (i > 100 ? 7'000 : 0) - (i > 103 ? 60'000 : 0) - (i > 200 ? 500 : 0));
  }
  EXPECT_EQ(filter(stamps), expected);
  EXPECT_EQ(diagnostics_.count("depth_clock_jump"), 3);
}

TEST_F(OrderedStreamTest, RowsThatAreWrittenTwiceAreNoJump) {
  std::vector<int64_t> stamps, expected;
  for (int i = 1; i <= 300; ++i) {
    expected.push_back(10 * i);
    stamps.push_back(10 * i);
    if (i != 150) continue;
    for (int again = 71; again <= 150; ++again) stamps.push_back(10 * again);
  }
  EXPECT_EQ(filter(stamps, 0.0, true), expected);
  EXPECT_EQ(diagnostics_.count("depth_clock_jump"), 0);
}

TEST_F(OrderedStreamTest, RefusesReverseOrder) {
  std::vector<int64_t> stamps;
  for (int i = 100; i > 0; --i) stamps.push_back(10 * i);
  EXPECT_THAT([&] { filter(stamps); }, testing::ThrowsMessage<InputError>(HasSubstr("reverse order")));
}

TEST_F(OrderedStreamTest, ShiftsWhatFollowsAJump) {
  std::vector<int64_t> stamps;
  for (int i = 1; i <= 20; ++i) stamps.push_back(10 * i + (i > 10 ? 5'000 : 0) + (i > 15 ? 7'000 : 0));
  OrderedStream<DepthSample> stream = streamOf(stamps, 0.0, false);
  for (int i = 1; i <= 20; ++i) {
    if (i == 5) stream.shiftFrom(Time::fromSeconds(1.0), Duration::fromSeconds(-5.0));
    if (i == 15) stream.shiftFrom(Time::fromSeconds(1.0), Duration::fromSeconds(-7.0));
    ASSERT_NE(stream.peek(), nullptr);
    EXPECT_EQ(stream.pop().time.nanoseconds(), int64_t{10'000'000} * i);
  }
}

TEST_F(OrderedStreamTest, ReadsAheadOnlyWhereReadingsAreMissing) {
  std::vector<int64_t> stamps;
  for (int i = 1; i <= 200; ++i) stamps.push_back(10 * (i + (i > 150 ? 3 : 0)));
  auto stream = streamOf(stamps, 0.0, false);
  for (size_t i = 0; i < 140; ++i) {
    ASSERT_NE(stream.peek(), nullptr);
    stream.pop();
    EXPECT_LE(pulled_, i + 2);
  }
}

TEST_F(OrderedStreamTest, ALiveSensorIsReadAheadOnlyWhereReadingsAreMissing) {
  look_ahead_ = 1;
  auto stream = streamOf({10, 20, 30, 60, 70, 80}, 0.0, false);
  for (const size_t pulled : {2, 2, 3, 5, 5, 6}) {
    ASSERT_NE(stream.peek(), nullptr);
    stream.pop();
    EXPECT_EQ(pulled_, pulled);
  }
  EXPECT_EQ(stream.peek(), nullptr);
}

TEST_F(OrderedStreamTest, ALiveCameraIsNotReadAhead) {
  look_ahead_ = 0;
  auto stream = streamOf({10, 20, 60, 70, 50, 80}, 0.0, false);
  for (const size_t pulled : {2, 2, 3, 4, 6}) {
    ASSERT_NE(stream.peek(), nullptr);
    stream.pop();
    EXPECT_EQ(pulled_, pulled);
  }
  EXPECT_EQ(stream.peek(), nullptr);
  EXPECT_EQ(diagnostics_.count("depth_disorder"), 1);
}

TEST_F(OrderedStreamTest, ALiveSensorMayHaveLateReadingsAndWildStamps) {
  look_ahead_ = 1;
  EXPECT_THAT(filter({10, 20, 40, 30, 50, 999'000, 60, 70}), ElementsAre(10, 20, 30, 40, 50, 60, 70));
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

TEST_F(OrderedStreamTest, SpreadsBurstsOut) {
  StreamExpectation expected{"imu", "IMU", 200.0, 0.02, Duration()};
  expected.spreads_bursts = true;
  int next = 0;
  OrderedStream<ImuSample> stream(
      expected,
      [&]() -> std::optional<ImuSample> {
        if (next == 400) return std::nullopt;
        const int i = next++;
        const int last_of_burst = i / 10 * 10 + 9;
        ImuSample sample;
        sample.time =
            Time::fromNanoseconds(int64_t{5'000'000} * last_of_burst + 100'000 * (i - last_of_burst));
        sample.angular_velocity_B.x() = i;
        return sample;
      },
      &diagnostics_);
  int count = 0;
  for (; stream.peek() != nullptr; ++count) {
    const ImuSample sample = stream.pop();
    EXPECT_EQ(sample.angular_velocity_B.x(), count);
    EXPECT_NEAR(sample.time.seconds(), 0.005 * count, 1e-4) << count;
  }
  EXPECT_EQ(count, 400);
  EXPECT_EQ(diagnostics_.count("imu_bursts"), 1);
  EXPECT_EQ(diagnostics_.ranked().size(), 1u);
}

}  // namespace
}  // namespace lodeline

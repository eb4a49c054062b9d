#include "lodeline/io/synchronizer/imu_interval.h"

#include <gtest/gtest.h>

#include <memory>

#include "lodeline/io/streams/ordered_stream.h"

namespace lodeline {
namespace {

Time ms(int64_t value) { return Time::fromNanoseconds(value * 1'000'000); }

/// Readings at the given times; the first gyroscope axis reads the time in seconds.
ImuIntervals intervalsOf(std::vector<int64_t> stamps_ms, double history_s, Diagnostics* diagnostics) {
  StreamExpectation expected;
  expected.kind = "imu";
  auto pull = [stamps_ms = std::move(stamps_ms), next = size_t{0}]() mutable -> std::optional<ImuSample> {
    if (next == stamps_ms.size()) return std::nullopt;
    const Time time = ms(stamps_ms[next++]);
    return ImuSample{time, Vec3(time.seconds(), 0.0, 0.0), Vec3(0.0, 0.0, -time.seconds())};
  };
  const auto stream = std::make_shared<OrderedStream<ImuSample>>(expected, std::move(pull), diagnostics);
  return ImuIntervals(
      [stream]() -> std::optional<ImuSample> {
        if (stream->peek() == nullptr) return std::nullopt;
        return stream->pop();
      },
      history_s);
}

using Coverage = ImuIntervals::Coverage;

TEST(ImuIntervals, InterpolatesBothBorders) {
  Diagnostics diagnostics;
  ImuIntervals intervals = intervalsOf({0, 10, 20, 30, 40}, 1.0, &diagnostics);
  double gap_s = 0.0;
  ASSERT_EQ(intervals.readUntil(ms(13)), Coverage::Covered);
  const std::vector<ImuSample> first = intervals.cut(ms(13), &gap_s);
  ASSERT_EQ(first.size(), 3u);
  EXPECT_EQ(first.back().time, ms(13));
  EXPECT_NEAR(first.back().angular_velocity_B.x(), 0.013, 1e-15);
  EXPECT_NEAR(first.back().specific_force_B.z(), -0.013, 1e-15);
  EXPECT_DOUBLE_EQ(gap_s, 0.010);

  ASSERT_EQ(intervals.readUntil(ms(37)), Coverage::Covered);
  const std::vector<ImuSample> second = intervals.cut(ms(37), &gap_s);
  ASSERT_EQ(second.size(), 4u);
  EXPECT_EQ(second.front().time, ms(13));
  EXPECT_EQ(second[1].time, ms(20));
  EXPECT_NEAR(second.back().angular_velocity_B.x(), 0.037, 1e-15);
}

TEST(ImuIntervals, KeepTheLengthOfAGapThatImagesDivide) {
  Diagnostics diagnostics;
  ImuIntervals intervals = intervalsOf({0, 10, 110, 120}, 1.0, &diagnostics);
  double gap_s = 0.0;
  for (const int64_t time_ms : {50, 100}) {
    ASSERT_EQ(intervals.readUntil(ms(time_ms)), Coverage::Covered);
    EXPECT_NEAR(intervals.cut(ms(time_ms), &gap_s).back().gap_s, 0.1, 1e-12);
  }
  ASSERT_EQ(intervals.readUntil(ms(115)), Coverage::Covered);
  const std::vector<ImuSample> last = intervals.cut(ms(115), &gap_s);
  ASSERT_EQ(last.size(), 3u);
  EXPECT_NEAR(last[1].gap_s, 0.1, 1e-12);
  EXPECT_NEAR(last[2].gap_s, 0.01, 1e-12);
}

TEST(ImuIntervals, TakesAReadingAtTheBorderAsItIs) {
  Diagnostics diagnostics;
  ImuIntervals intervals = intervalsOf({0, 10, 20, 30}, 1.0, &diagnostics);
  double gap_s = 0.0;
  ASSERT_EQ(intervals.readUntil(ms(10)), Coverage::Covered);
  EXPECT_EQ(intervals.cut(ms(10), &gap_s).size(), 2u);
  ASSERT_EQ(intervals.readUntil(ms(30)), Coverage::Covered);
  const std::vector<ImuSample> second = intervals.cut(ms(30), &gap_s);
  ASSERT_EQ(second.size(), 3u);
  EXPECT_EQ(second.front().time, ms(10));
  EXPECT_EQ(second.back().time, ms(30));
}

TEST(ImuIntervals, CutsTwiceBetweenTwoReadings) {
  Diagnostics diagnostics;
  ImuIntervals intervals = intervalsOf({0, 100}, 1.0, &diagnostics);
  double gap_s = 0.0;
  ASSERT_EQ(intervals.readUntil(ms(20)), Coverage::Covered);
  intervals.cut(ms(20), &gap_s);
  ASSERT_EQ(intervals.readUntil(ms(60)), Coverage::Covered);
  const std::vector<ImuSample> inside = intervals.cut(ms(60), &gap_s);
  ASSERT_EQ(inside.size(), 2u);
  EXPECT_NEAR(inside[1].angular_velocity_B.x(), 0.06, 1e-15);
  // The gap is that between the real readings, although the interval is shorter.
  EXPECT_DOUBLE_EQ(gap_s, 0.1);
}

TEST(ImuIntervals, KnowsWhatItCannotCover) {
  Diagnostics diagnostics;
  ImuIntervals intervals = intervalsOf({10, 20}, 1.0, &diagnostics);
  EXPECT_EQ(intervals.readUntil(ms(9)), Coverage::BeforeFirst);
  EXPECT_EQ(intervals.readUntil(ms(20)), Coverage::Covered);
  EXPECT_EQ(intervals.readUntil(ms(21)), Coverage::AfterLast);
  ImuIntervals none = intervalsOf({}, 1.0, &diagnostics);
  EXPECT_EQ(none.readUntil(ms(0)), Coverage::AfterLast);
}

TEST(ImuIntervals, HoldsNoMoreThanTheHistory) {
  Diagnostics diagnostics;
  std::vector<int64_t> stamps_ms;
  for (int64_t i = 0; i < 100'000; ++i) stamps_ms.push_back(10 * i);
  ImuIntervals intervals = intervalsOf(stamps_ms, 2.0, &diagnostics);
  ASSERT_EQ(intervals.readUntil(ms(500'000)), Coverage::Covered);
  EXPECT_EQ(intervals.size(), 201u);
}

TEST(ImuIntervals, KeepsTheReadingBeforeTheCutWithoutHistory) {
  Diagnostics diagnostics;
  ImuIntervals intervals = intervalsOf({0, 10, 20, 30}, 0.0, &diagnostics);
  double gap_s = 0.0;
  ASSERT_EQ(intervals.readUntil(ms(25)), Coverage::Covered);
  const std::vector<ImuSample> first = intervals.cut(ms(25), &gap_s);
  ASSERT_EQ(first.size(), 2u);
  EXPECT_EQ(first[0].time, ms(20));
}

}  // namespace
}  // namespace lodeline

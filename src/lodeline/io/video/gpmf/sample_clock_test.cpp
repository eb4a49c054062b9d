#include "lodeline/io/video/gpmf/sample_clock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace lodeline::gpmf {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kPeriod_s = 1.001;

/// A sensor whose samples a camera takes over in bursts, late by up to 15 ms.
struct SimulatedSensor {
  double rate_hz = 397.3;
  double start_s = 0.012;
  size_t burst = 7;
  int payloads = 60;
  double warming = 0.0;  ///< relative growth of the rate by the end
  std::optional<double> clock_s = std::nullopt;

  double end_s() const { return payloads * kPeriod_s; }
  /// Samples taken until a time; the rate grows linearly.
  double taken(double time_s) const {
    const double t = time_s - start_s;
    return t <= 0.0 ? 0.0 : rate_hz * (t + 0.5 * warming * t * t / end_s());
  }
  double timeOf(double n) const {
    double time_s = start_s + n / rate_hz;
    for (int i = 0; i < 20; ++i) {
      const double rate = rate_hz * (1.0 + warming * (time_s - start_s) / end_s());
      time_s -= (taken(time_s) - n) / rate;
    }
    return time_s;
  }

  std::vector<PayloadSamples> payloadsOf() const {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> late_s(0.0, 0.015);
    std::vector<PayloadSamples> result;
    size_t before = 0;
    for (int k = 0; k < payloads; ++k) {
      const double until_s = (k + 1) * kPeriod_s - late_s(random);
      const auto total = static_cast<size_t>(taken(until_s) / static_cast<double>(burst)) * burst;
      PayloadSamples payload{k * kPeriod_s, kPeriod_s, total - before, total};
      if (clock_s) payload.stamp_s = *clock_s + timeOf(static_cast<double>(before));
      result.push_back(payload);
      before = total;
    }
    return result;
  }
};

/// Largest difference of the errors of times over a record: the constant delay is not the clock's task.
double spread_s(const SampleClock& clock, const SimulatedSensor& sensor) {
  double least = 1e9, greatest = -1e9;
  for (double n = 0.0; n < clock.samples(); n += clock.samples() / 500.0) {
    const double error_s = clock.time_s(n) - sensor.timeOf(n);
    least = std::min(least, error_s);
    greatest = std::max(greatest, error_s);
  }
  return greatest - least;
}

TEST(SampleClock, FindsTheRateBehindBursts) {
  const SimulatedSensor sensor;
  const SampleClock clock(sensor.payloadsOf());
  EXPECT_NEAR(clock.rate_hz() / sensor.rate_hz, 1.0, 1e-4);
  EXPECT_LT(spread_s(clock, sensor), 0.006);
  EXPECT_NEAR(clock.time_s(0.0), sensor.start_s, 0.030);  // with the delay of the hand-over
  EXPECT_THAT(clock.problems(), IsEmpty());
}

TEST(SampleClock, FollowsARateThatGrowsWithTheTemperature) {
  SimulatedSensor sensor;
  sensor.payloads = 3600;
  sensor.warming = 1e-3;
  sensor.burst = 1;
  EXPECT_LT(spread_s(SampleClock(sensor.payloadsOf()), sensor), 0.010);  // a single line is off by 0.45 s
}

TEST(SampleClock, UsesStampsAndAMapOfTheClock) {
  SimulatedSensor sensor;
  sensor.clock_s = 100.0;
  const SampleClock clock(sensor.payloadsOf(), ClockLine{100.0, 0.0, 1.0});
  for (double n = 0.0; n < clock.samples(); n += 1000.0) {
    EXPECT_NEAR(clock.time_s(n), sensor.timeOf(n), 1e-4);
  }
}

TEST(SampleClock, UsesStampsWithThePayloadTimes) {
  SimulatedSensor sensor;
  sensor.clock_s = 100.0;
  EXPECT_LT(spread_s(SampleClock(sensor.payloadsOf()), sensor), 0.003);
}

TEST(SampleClock, NumbersSamplesAcrossALoss) {
  SimulatedSensor sensor;
  sensor.burst = 1;
  std::vector<PayloadSamples> payloads = sensor.payloadsOf();
  const size_t lost = payloads[20].samples;
  payloads.erase(payloads.begin() + 20);
  const SampleClock clock(payloads);
  EXPECT_THAT(clock.problems(), ElementsAre(HasSubstr("lost " + std::to_string(lost) + " samples")));
  EXPECT_LT(spread_s(clock, sensor), 0.010);
}

TEST(SampleClock, DoesWithoutCounts) {
  const SimulatedSensor sensor;
  std::vector<PayloadSamples> payloads = sensor.payloadsOf();
  for (PayloadSamples& payload : payloads) payload.total_samples.reset();
  EXPECT_LT(spread_s(SampleClock(payloads), sensor), 0.006);
}

TEST(SampleClock, PassesOverADamagedCount) {
  const SimulatedSensor sensor;
  std::vector<PayloadSamples> payloads = sensor.payloadsOf();
  *payloads[20].total_samples += 1'000'000'000;
  const SampleClock clock(payloads);
  EXPECT_THAT(clock.problems(), testing::Each(HasSubstr("leaps")));
  EXPECT_LT(spread_s(clock, sensor), 0.006);
}

TEST(SampleClock, CountsOnThroughAChapterThatStartsAnew) {
  SimulatedSensor sensor;
  std::vector<PayloadSamples> payloads = sensor.payloadsOf();
  const uint64_t before = *payloads[29].total_samples;
  for (size_t i = 30; i < payloads.size(); ++i) *payloads[i].total_samples -= before;
  payloads[30].starts_file = true;
  const SampleClock clock(payloads);
  EXPECT_THAT(clock.problems(), IsEmpty());
  EXPECT_LT(spread_s(clock, sensor), 0.006);
}

TEST(SampleClock, IsNotMovedByOnePayloadTime) {
  const SimulatedSensor sensor;
  std::vector<PayloadSamples> payloads = sensor.payloadsOf();
  payloads[10].time_s += 3.0;
  EXPECT_LT(spread_s(SampleClock(payloads), sensor), 0.006);
}

TEST(SampleClock, TakesTheLengthOfASinglePayload) {
  const SampleClock clock({{2.0, 1.0, 200, 200}});
  EXPECT_NEAR(clock.rate_hz(), 200.0, 1e-9);
  EXPECT_NEAR(clock.time_s(100.0), 2.5, 1e-9);
}

TEST(SampleClock, HasNoRateWithoutTwoTimes) {
  EXPECT_EQ(SampleClock(std::vector<PayloadSamples>{}).rate_hz(), 0.0);
  EXPECT_EQ(SampleClock({{2.0, 0.0, 200, 200}}).rate_hz(), 0.0);
  EXPECT_EQ(SampleClock({{2.0, 1.0, 0, 0}, {3.0, 1.0, 0, 0}}).rate_hz(), 0.0);
}

}  // namespace
}  // namespace lodeline::gpmf

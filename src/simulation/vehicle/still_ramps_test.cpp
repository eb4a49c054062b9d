#include "simulation/vehicle/still_ramps.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {

TEST(StillRamps, ReadingsFollowTheCurrentsByTheTrueCoefficients) {
  StillRampsOptions options;
  options.noise = false;
  options.current_rate_hz = 50.0;
  const StillRamps test = simulateStillRamps(options);
  ASSERT_EQ(test.true_currents.channels.size(), test.true_currents.fields_T_per_A.size());
  const MagnetometerErrors& e = test.magnetometer_errors;
  const Vec3 still_M = e.soft_iron * (e.body_from_magnetometer.rotation.conjugate() *
                                      (test.world_from_body.rotation.conjugate() * options.field_W)) +
                       e.hard_iron_T;
  const LoadsFunction loads = rampedLoads(options.times);
  for (const MagnetometerSample& sample : test.magnetometer) {
    const std::vector<double> currents_A = channelCurrents(loads((sample.time - options.start).seconds()));
    const Vec3 expected = still_M + fieldOfCurrents(test.true_currents.fields_T_per_A, currents_A);
    ASSERT_LT((sample.field_M - expected).norm(), 1e-12);
  }
}

TEST(StillRamps, EveryChannelRisesToItsLargestCurrentWhileTheOthersRest) {
  const RampTimes times;
  const LoadsFunction loads = rampedLoads(times);
  const std::vector<double> before = channelCurrents(loads(0.0));
  for (size_t channel = 0; channel < before.size(); ++channel) {
    const double middle_s =
        times.before_s + static_cast<double>(channel) * times.each_s() + times.ramp_s + 0.5 * times.hold_s;
    const std::vector<double> currents_A = channelCurrents(loads(middle_s));
    const double rise_A = channel < kThrusters ? 20.0 : channel < kThrusters + kLamps ? 2.0 : 3.0;
    for (size_t other = 0; other < before.size(); ++other) {
      // The battery carries the sum.
      const bool rises = other == channel || other + 1 == before.size();
      EXPECT_NEAR(currents_A[other] - before[other], rises ? rise_A : 0.0, 1e-12) << channel << other;
    }
  }
  EXPECT_EQ(channelCurrents(loads(times.duration_s())), before);
}

TEST(StillRamps, ThrustersDisturbBySixToTwelveMicrotesla) {
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    const std::vector<Vec3> fields = drawCurrentFields(seed, false), moved = drawCurrentFields(seed, true);
    for (int i = 0; i < kThrusters; ++i) {
      EXPECT_GE(20.0 * fields[i].norm(), 6e-6);
      EXPECT_LE(20.0 * fields[i].norm(), 12e-6);
    }
    for (size_t i = 0; i < fields.size(); ++i) {
      EXPECT_LT(fields[i].normalized().dot(moved[i].normalized()), 0.88);
      EXPECT_GT(fields[i].normalized().dot(moved[i].normalized()), 0.33);
    }
  }
}

TEST(StillRamps, SameSeedSameReadingsAndTheSecondDayHasTheSameSensor) {
  StillRampsOptions options;
  const StillRamps first = simulateStillRamps(options), again = simulateStillRamps(options);
  options.cables_moved = true;
  const StillRamps second = simulateStillRamps(options);
  EXPECT_EQ(first.magnetometer.size(), second.magnetometer.size());
  for (size_t i = 0; i < first.magnetometer.size(); ++i)
    ASSERT_EQ(first.magnetometer[i].field_M, again.magnetometer[i].field_M);
  EXPECT_EQ(first.magnetometer_errors.hard_iron_T, second.magnetometer_errors.hard_iron_T);
  EXPECT_NE(first.magnetometer.front().field_M, second.magnetometer.front().field_M);
}

}  // namespace
}  // namespace lodeline

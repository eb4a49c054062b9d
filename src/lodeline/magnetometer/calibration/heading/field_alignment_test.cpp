#include "lodeline/magnetometer/calibration/heading/field_alignment.h"

#include <gtest/gtest.h>

#include "lodeline/magnetometer/calibration/heading/test_turning_sensor.h"

namespace lodeline {
namespace {

TEST(FieldAlignment, FindsAnyRotationTheLagAndTheBias) {
  for (const Vec3& turn : {Vec3(0.0, 0.0, 0.0), Vec3(0.3, -1.1, 0.6), Vec3(3.1, 0.1, 0.0)}) {
    test::TurningSensor sensor;
    sensor.truth.body_from_magnetometer = so3::exp(turn);
    const auto alignment = alignField(sensor.correctedField(), sensor.imu());
    ASSERT_TRUE(alignment);
    EXPECT_LT(alignment->body_from_magnetometer.angularDistance(sensor.truth.body_from_magnetometer), 2e-3);
    EXPECT_NEAR(alignment->time_offset_s, sensor.truth.time_offset_s, 1e-3);
    EXPECT_LT((alignment->gyroscope_bias_B - sensor.gyroscope_bias).norm(), 2e-3);
    EXPECT_GT(alignment->distinctness, 50.0);
  }
}

TEST(FieldAlignment, WorksAtTenHertzAndAtOneKilohertz) {
  for (const double rate_hz : {10.0, 1000.0}) {
    test::TurningSensor sensor;
    sensor.field_rate_hz = rate_hz;
    sensor.duration_s = 20.0;
    const auto alignment = alignField(sensor.correctedField(), sensor.imu());
    ASSERT_TRUE(alignment) << rate_hz;
    EXPECT_LT(alignment->body_from_magnetometer.angularDistance(sensor.truth.body_from_magnetometer), 5e-3);
  }
}

TEST(FieldAlignment, KnowsThatTurnsAboutOneAxisSayTooLittle) {
  test::TurningSensor sensor;
  sensor.motion.b.setZero();
  sensor.gyroscope_bias.setZero();
  const auto alignment = alignField(sensor.correctedField(), sensor.imu());
  ASSERT_TRUE(alignment);
  EXPECT_LT(alignment->distinctness, 4.0);
}

TEST(FieldAlignment, NeedsReadingsAtTheSameTime) {
  const test::TurningSensor sensor;
  std::vector<NormalizedFieldSample> later = sensor.correctedField();
  for (NormalizedFieldSample& sample : later) sample.time = sample.time + Duration::fromSeconds(1000.0);
  EXPECT_FALSE(alignField(later, sensor.imu()));
  EXPECT_FALSE(alignField({}, sensor.imu()));
}

}  // namespace
}  // namespace lodeline

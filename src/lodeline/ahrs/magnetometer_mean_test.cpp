#include "lodeline/ahrs/magnetometer_mean.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/imu/test_motion.h"

namespace lodeline {
namespace {

const TestMotion kMotion;
const Vec3 kField_W(1e-6, 24e-6, -38e-6);
const Vec3 kGyroscopeBias(0.01, -0.02, 0.03);

std::vector<ImuSample> readings(double begin_s, double end_s) {
  return kMotion.readings(begin_s, end_s, 200.0, kGyroscopeBias, Vec3::Zero());
}

Quat worldFromBody(Time time) {
  return kMotion.state(time, Vec3::Zero(), Vec3::Zero()).world_from_body.rotation;
}

// The field at `rate_hz` within [begin, end], at times different from the IMU's, with an offset in the body
// frame.
std::vector<FieldSample> field(double begin_s, double end_s, double rate_hz, const Vec3& offset_B) {
  std::vector<FieldSample> samples;
  for (double t = begin_s; t <= end_s + 1e-9; t += 1.0 / rate_hz) {
    const Time time = Time::fromSeconds(t);
    samples.push_back({time, worldFromBody(time).conjugate() * kField_W + offset_B});
  }
  return samples;
}

TEST(CarryToFrame, BringsEveryReadingToTheFrame) {
  const auto imu = readings(1.0, 1.3);
  const Vec3 expected = worldFromBody(imu.back().time).conjugate() * kField_W;
  for (const double begin_s : {1.0, 1.0021, 1.25, 1.3}) {
    const MagnetometerMean mean =
        carryToFrame(field(begin_s, 1.3, 37.0, Vec3::Zero()), imu, kGyroscopeBias, 0.0);
    EXPECT_LT((mean.field_B - expected).norm(), 1e-4 * kField_W.norm()) << begin_s;
    EXPECT_LT((mean.newest_B - expected).norm(), 1e-4 * kField_W.norm()) << begin_s;
    EXPECT_EQ(mean.time, imu.back().time);
  }
}

TEST(CarryToFrame, NeedsTheBias) {
  const auto imu = readings(1.0, 1.3);
  const Vec3 expected = worldFromBody(imu.back().time).conjugate() * kField_W;
  const MagnetometerMean mean = carryToFrame(field(1.0, 1.29, 50.0, Vec3::Zero()), imu, Vec3::Zero(), 0.0);
  EXPECT_GT((mean.field_B - expected).norm(), 1e-3 * kField_W.norm());
}

TEST(CarryToFrame, TellsHowAnOffsetShows) {
  const auto imu = readings(1.0, 2.0);
  const Vec3 offset_B(3e-6, -2e-6, 1e-6);
  const Vec3 without = carryToFrame(field(1.0, 2.0, 50.0, Vec3::Zero()), imu, kGyroscopeBias, 0.0).field_B;
  const MagnetometerMean mean = carryToFrame(field(1.0, 2.0, 50.0, offset_B), imu, kGyroscopeBias, 0.0);
  EXPECT_LT((mean.field_B - without - mean.carried * offset_B).norm(), 1e-12);
  EXPECT_GT((mean.carried * offset_B - offset_B).norm(), 0.05 * offset_B.norm()) << "nothing turns here";
}

TEST(CarryToFrame, StatesTheGyroscopesShare) {
  constexpr double kDensity = 0.01;  // rad/s/sqrt(Hz), a large value
  constexpr int kRuns = 400;
  const auto quiet = readings(1.0, 1.2);
  const auto samples = field(1.0, 1.19, 50.0, Vec3::Zero());
  const Vec3 expected = worldFromBody(quiet.back().time).conjugate() * kField_W;
  const double stated = carryToFrame(samples, quiet, kGyroscopeBias, kDensity).rotation_sigma_rad;
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0.0, kDensity * std::sqrt(200.0));
  double squares = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    auto imu = quiet;
    for (ImuSample& s : imu) s.angular_velocity_B += Vec3(normal(random), normal(random), normal(random));
    const Vec3 error = carryToFrame(samples, imu, kGyroscopeBias, kDensity).field_B - expected;
    squares += error.squaredNorm() / (2.0 * expected.squaredNorm());  // two axes normal to the field
  }
  EXPECT_NEAR(std::sqrt(squares / kRuns) / stated, 1.0, 0.1);
}

TEST(CarryToFrame, RefusesReadingsThatTheImuDoesNotCover) {
  const auto imu = readings(1.0, 1.3);
  EXPECT_THROW(carryToFrame(field(0.9, 1.2, 50.0, Vec3::Zero()), imu, Vec3::Zero(), 0.0), InputError);
  EXPECT_THROW(carryToFrame(field(1.1, 1.4, 50.0, Vec3::Zero()), imu, Vec3::Zero(), 0.0), InputError);
  EXPECT_THROW(carryToFrame({}, imu, Vec3::Zero(), 0.0), InputError);
  EXPECT_THROW(carryToFrame(field(1.1, 1.2, 50.0, Vec3::Zero()), {}, Vec3::Zero(), 0.0), InputError);
}

}  // namespace
}  // namespace lodeline

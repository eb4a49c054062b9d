#include "lodeline/imu/gravity_alignment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lodeline/diagnostics.h"
#include "lodeline/imu/test_motion.h"

namespace lodeline {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

// A rig at rest with the noise of a good MEMS sensor (EuRoC's ADIS16448 at 200 Hz).
std::vector<ImuSample> atRest(const Quat& world_from_body, const Vec3& gyroscope_bias, double duration_s) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto gaussian = [&](double sigma) {
    return Vec3(sigma * Vec3(normal(random), normal(random), normal(random)));
  };
  std::vector<ImuSample> samples;
  for (int i = 0; i <= std::lround(duration_s * 200.0); ++i) {
    samples.push_back({Time::fromNanoseconds(i * 5'000'000), gyroscope_bias + gaussian(2.4e-3),
                       world_from_body.conjugate() * -standardGravity_W() + gaussian(0.028)});
  }
  return samples;
}

double tiltError(const Quat& estimate, const Quat& truth) {
  const Vec3 up_estimate = estimate.conjugate() * Vec3::UnitZ();
  const Vec3 up_truth = truth.conjugate() * Vec3::UnitZ();
  return up_estimate.cross(up_truth).norm();
}

TEST(GravityAlignment, FindsUpInAnyAttitude) {
  for (const Vec3& rotation_vector :
       {Vec3(0, 0, 0), Vec3(0.4, -0.3, 2.0), Vec3(0, -M_PI / 2, 0), Vec3(0, M_PI / 2, 0), Vec3(M_PI, 0, 0),
        Vec3(M_PI / 2, 0, 0), Vec3(1.2, 1.2, -1.2)}) {
    const Quat truth = so3::exp(rotation_vector);
    const GravityAlignment alignment = alignWithGravity(atRest(truth, Vec3::Zero(), 1.0), Vec3::Zero());
    EXPECT_LT(tiltError(alignment.world_from_body, truth), 1e-3) << rotation_vector.transpose();
    EXPECT_TRUE(alignment.still);
    EXPECT_NEAR(alignment.world_from_body.norm(), 1.0, 1e-12);
  }
}

TEST(GravityAlignment, YawOfTheXAxisIsZero) {
  const Quat attitude = Eigen::AngleAxisd(0.7, Vec3::UnitZ()) * Eigen::AngleAxisd(-0.3, Vec3::UnitY()) *
                        Eigen::AngleAxisd(0.2, Vec3::UnitX());
  const Quat estimate = alignWithGravity(atRest(attitude, Vec3::Zero(), 1.0), Vec3::Zero()).world_from_body;
  const Vec3 ahead = estimate * Vec3::UnitX();
  EXPECT_NEAR(ahead.y(), 0.0, 1e-12);
  EXPECT_NEAR(ahead.x(), std::cos(0.3), 1e-3);
}

TEST(GravityAlignment, YawOfTheZAxisIsZeroWhereXIsSteep) {
  // Mounting as in EuRoC's rig: x up, z ahead.
  const Quat attitude = so3::exp(Vec3(0.0, 0.0, 0.7)) * so3::exp(Vec3(0.0, -M_PI / 2, 0.0));
  const Quat estimate = alignWithGravity(atRest(attitude, Vec3::Zero(), 1.0), Vec3::Zero()).world_from_body;
  const Vec3 ahead = estimate * Vec3::UnitZ();
  EXPECT_NEAR(ahead.y(), 0.0, 1e-12);
  EXPECT_GT(ahead.x(), 0.99);
}

TEST(GravityAlignment, AtRestTheMeanRateIsTheBias) {
  const Vec3 bias(-0.002, 0.021, 0.077);
  const GravityAlignment alignment = alignWithGravity(atRest(Quat::Identity(), bias, 2.0), Vec3::Zero());
  EXPECT_TRUE(alignment.still);
  EXPECT_LT((alignment.gyroscope_bias_B - bias).norm(), 5e-4);
  // Nearly all of the remaining error is due to the unknown accelerometer bias.
  EXPECT_LT(alignment.tilt_sigma_rad, 2e-3);
  EXPECT_LT(tiltError(alignment.world_from_body, Quat::Identity()), 1e-3);
}

TEST(GravityAlignment, ATenthOfASecondDoesNotShowRest) {
  const Vec3 rate(0.05, -0.03, 0.02);
  const auto samples = atRest(Quat::Identity(), rate, 1.0);
  const GravityAlignment alignment = alignWithGravity(std::span(samples).last(21), Vec3::Zero());
  EXPECT_FALSE(alignment.still);
  EXPECT_EQ(alignment.gyroscope_bias_B, Vec3::Zero());
  EXPECT_GT(alignment.tilt_sigma_rad, 0.1);
}

TEST(GravityAlignment, TurnsReadingsOfAMovingRigIntoTheLastFrame) {
  const Vec3 bias(0.05, -0.02, 0.03);
  const Vec3 rate(0.5, 0.8, -0.6);
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 400; ++i) {
    const Time time = Time::fromNanoseconds(i * 5'000'000);
    samples.push_back(
        {time, rate + bias, so3::exp(rate * time.seconds()).conjugate() * -standardGravity_W()});
  }
  const GravityAlignment alignment = alignWithGravity(samples, bias);
  EXPECT_FALSE(alignment.still);
  EXPECT_EQ(alignment.gyroscope_bias_B, bias);
  EXPECT_LT(tiltError(alignment.world_from_body, so3::exp(rate * 2.0)), 1e-9);
}

TEST(GravityAlignment, AMovingRigKnowsUpLessWellTheShorterTheTime) {
  const TestMotion motion;
  double longer_sigma = 0.0;
  for (const double duration_s : {4.0, 2.0, 1.0}) {
    const auto samples = motion.readings(0.0, duration_s, 200.0);
    const GravityAlignment alignment = alignWithGravity(samples, Vec3::Zero());
    EXPECT_FALSE(alignment.still);
    EXPECT_GT(alignment.tilt_sigma_rad, longer_sigma);
    EXPECT_LT(tiltError(alignment.world_from_body, motion.rotation(duration_s)),
              4.0 * alignment.tilt_sigma_rad);
    longer_sigma = alignment.tilt_sigma_rad;
  }
}

TEST(GravityAlignment, OneReadingGivesUpWithTheUncertaintyOfMotion) {
  const Quat attitude = so3::exp(Vec3(0.4, -0.3, 0.0));
  const auto samples = atRest(attitude, Vec3::Zero(), 0.5);
  const GravityAlignmentOptions options;
  const GravityAlignment one = alignWithGravity(std::span(samples).first(1), Vec3(0.1, 0, 0), options);
  EXPECT_LT(tiltError(one.world_from_body, attitude), 0.02);
  EXPECT_FALSE(one.still);
  EXPECT_EQ(one.gyroscope_bias_B, Vec3(0.1, 0, 0));
  EXPECT_NEAR(one.tilt_sigma_rad, options.acceleration_sigma_m_per_s2 / 9.8, 0.01);
}

TEST(GravityAlignment, RefusesWhatDoesNotShowUp) {
  auto samples = atRest(Quat::Identity(), Vec3::Zero(), 0.5);
  EXPECT_THROW(alignWithGravity(std::span(samples).first(0), Vec3::Zero()), InputError);
  // Readings in multiples of g instead of m/s^2.
  for (ImuSample& sample : samples) sample.specific_force_B /= 9.80665;
  EXPECT_THAT([&] { alignWithGravity(samples, Vec3::Zero()); },
              ThrowsMessage<EstimationError>(HasSubstr("1.00 m/s^2")));
  samples[5].time = samples[4].time;
  EXPECT_THROW(alignWithGravity(samples, Vec3::Zero()), InputError);
}

}  // namespace
}  // namespace lodeline

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lodeline/imu/preintegration.h"
#include "lodeline/imu/test_motion.h"

namespace lodeline {
namespace {

using namespace inertial_error;
using Vec15 = Eigen::Matrix<double, 15, 1>;

const TestMotion kMotion;

PreintegrationOptions uninflated() {
  PreintegrationOptions options;
  options.noise_inflation = 1.0;
  options.motion_noise = MotionNoiseOptions::none();
  return options;
}

// Simulates readings of a true motion with white noise and random walks of the biases, and returns the
// resulting error.
Vec15 drawError(const ImuCalibration& imu, double duration_s, std::mt19937& random, Preintegration* out) {
  std::normal_distribution<double> normal;
  const auto gaussian = [&](double sigma) {
    return Vec3(sigma * Vec3(normal(random), normal(random), normal(random)));
  };
  auto samples = kMotion.readings(1.0, 1.0 + duration_s, imu.rate_hz);
  Vec3 gyroscope_bias = Vec3::Zero(), accelerometer_bias = Vec3::Zero();
  for (size_t i = 0; i < samples.size(); ++i) {
    if (i > 0) {
      gyroscope_bias += gaussian(imu.noise.gyroscope_random_walk_rad_per_s2_sqrtHz / std::sqrt(imu.rate_hz));
      accelerometer_bias +=
          gaussian(imu.noise.accelerometer_random_walk_m_per_s3_sqrtHz / std::sqrt(imu.rate_hz));
    }
    samples[i].angular_velocity_B +=
        gyroscope_bias + gaussian(imu.noise.gyroscope_density_rad_per_s_sqrtHz * std::sqrt(imu.rate_hz));
    samples[i].specific_force_B +=
        accelerometer_bias +
        gaussian(imu.noise.accelerometer_density_m_per_s2_sqrtHz * std::sqrt(imu.rate_hz));
  }
  *out = Preintegration(samples, Vec3::Zero(), Vec3::Zero(), imu, uninflated());
  Vec15 error;
  error << motionError(kMotion.state(samples.front().time), kMotion.state(samples.back().time), *out,
                       standardGravity_W()),
      gyroscope_bias, accelerometer_bias;
  return error;
}

class PreintegrationCovariance : public testing::TestWithParam<double> {};

TEST_P(PreintegrationCovariance, AgreesWithMonteCarlo) {
  constexpr int kRuns = 300;
  ImuCalibration imu;
  // Random walks large enough to be significant within the interval.
  imu.noise.gyroscope_random_walk_rad_per_s2_sqrtHz = 5e-4;
  Preintegration preintegration(kMotion.readings(0.0, 0.1, 200.0), Vec3::Zero(), Vec3::Zero(), imu);
  std::mt19937 random(1);
  double total = 0.0;
  Eigen::Matrix<double, 5, 1> by_block = Eigen::Matrix<double, 5, 1>::Zero();
  Vec15 whitened_sum = Vec15::Zero();
  for (int run = 0; run < kRuns; ++run) {
    const Vec15 error = drawError(imu, GetParam(), random, &preintegration);
    const Vec15 whitened = preintegration.whitening() * error;
    whitened_sum += whitened;
    total += whitened.squaredNorm();
    for (int block = 0; block < 5; ++block) {
      const Vec3 part = error.segment<3>(3 * block);
      const Mat3 covariance = preintegration.covariance().block<3, 3>(3 * block, 3 * block);
      by_block[block] += part.dot(covariance.inverse() * part);
    }
  }
  // Four sigma of a mean of chi-squares.
  EXPECT_NEAR(total / kRuns, 15.0, 4.0 * std::sqrt(2.0 * 15.0 / kRuns));
  for (int block = 0; block < 5; ++block) {
    EXPECT_NEAR(by_block[block] / kRuns, 3.0, 4.0 * std::sqrt(2.0 * 3.0 / kRuns)) << block;
  }
  EXPECT_LT((whitened_sum / kRuns).cwiseAbs().maxCoeff(), 4.0 / std::sqrt(kRuns));
}

INSTANTIATE_TEST_SUITE_P(Durations, PreintegrationCovariance, testing::Values(0.05, 0.2, 0.6),
                         [](const auto& info) {
                           return std::to_string(std::lround(info.param * 1e3)) + "ms";
                         });

TEST(PreintegrationNoise, InflationScalesEverySigma) {
  const auto samples = kMotion.readings(0.0, 0.1, 200.0);
  PreintegrationOptions tripled = uninflated();
  tripled.noise_inflation = 3.0;
  const Preintegration plain(samples, Vec3::Zero(), Vec3::Zero(), ImuCalibration(), uninflated());
  const Preintegration inflated(samples, Vec3::Zero(), Vec3::Zero(), ImuCalibration(), tripled);
  EXPECT_LT((inflated.covariance() - 9.0 * plain.covariance()).norm(), 1e-12 * inflated.covariance().norm());
}

TEST(PreintegrationNoise, AnIntervalOfOneStepCanBeWhitened) {
  const Preintegration at(kMotion.readings(0.0, 0.005, 200.0), Vec3::Zero(), Vec3::Zero(), ImuCalibration());
  const Preintegration::Mat15 product = at.whitening() * at.covariance() * at.whitening().transpose();
  EXPECT_LT((product - Preintegration::Mat15::Identity()).norm(), 1e-9);
}

// The noise of the integrated motion must not depend on the spacing of the readings.
TEST(PreintegrationNoise, DoesNotDependOnHowAnIntervalIsCut) {
  const auto samples = kMotion.readings(0.0, 0.1, 200.0);
  auto cut = samples;
  cut.insert(cut.begin() + 1, kMotion.reading(Time::fromSeconds(0.0003)));
  const Preintegration whole(samples, Vec3::Zero(), Vec3::Zero(), ImuCalibration(), uninflated());
  const Preintegration pieces(cut, Vec3::Zero(), Vec3::Zero(), ImuCalibration(), uninflated());
  const auto sigmas = [](const Preintegration& p) { return Vec15(p.covariance().diagonal().cwiseSqrt()); };
  EXPECT_LT((sigmas(pieces) - sigmas(whole)).cwiseQuotient(sigmas(whole)).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(PreintegrationGap, AddsTheUncertaintyOfMotionThatWasOnlyInterpolated) {
  const auto samples = kMotion.readings(0.0, 0.3, 200.0);
  auto holed = samples;
  holed.erase(holed.begin() + 10, holed.begin() + 49);
  ASSERT_NEAR((holed[10].time - holed[9].time).seconds(), 0.2, 1e-9);
  const PreintegrationOptions options = uninflated();
  const Preintegration whole(samples, Vec3::Zero(), Vec3::Zero(), ImuCalibration(), options);
  const Preintegration gap(holed, Vec3::Zero(), Vec3::Zero(), ImuCalibration(), options);
  const Vec15 added = (gap.covariance() - whole.covariance()).diagonal();
  const double rotation_variance = std::pow(0.2 * options.gap_rate_sigma_rad_per_s, 2);
  const double velocity_variance = std::pow(0.2 * options.gap_specific_force_sigma_m_per_s2, 2);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(added[kTheta + axis], rotation_variance, 0.05 * rotation_variance);
    // The part of the force itself; gravity rotated by a wrong attitude adds to it.
    EXPECT_GT(added[kBeta + axis], 0.99 * velocity_variance);
    EXPECT_NEAR(added[kGyroscopeBias + axis], 0.0, 1e-15);
  }
  const auto error = motionError(kMotion.state(samples.front().time), kMotion.state(samples.back().time), gap,
                                 standardGravity_W());
  EXPECT_LT(error.dot(gap.covariance().topLeftCorner<9, 9>().llt().solve(error)) / 9.0, 1.0);
  EXPECT_GT(error.dot(whole.covariance().topLeftCorner<9, 9>().llt().solve(error)) / 9.0, 10.0);
}

// Images at a high rate divide a gap into steps that are individually short.
TEST(PreintegrationGap, CountsForEveryPartOfIt) {
  const auto samples = kMotion.readings(0.0, 0.01, 200.0);
  auto within_gap = samples;
  for (ImuSample& sample : within_gap) sample.gap_s = 1.0;
  const PreintegrationOptions options = uninflated();
  const Preintegration plain(samples, Vec3::Zero(), Vec3::Zero(), ImuCalibration(), options);
  const Preintegration part(within_gap, Vec3::Zero(), Vec3::Zero(), ImuCalibration(), options);
  const Vec15 added = (part.covariance() - plain.covariance()).diagonal();
  const double least = std::pow(0.01 * options.gap_rate_sigma_rad_per_s, 2);
  for (int axis = 0; axis < 3; ++axis) EXPECT_GT(added[kTheta + axis], least);
}

TEST(PreintegrationGap, ASlowSensorHasNone) {
  ImuCalibration slow;
  slow.rate_hz = 25.0;
  ImuCalibration fast;
  const auto samples = kMotion.readings(0.0, 0.4, 25.0);
  const Preintegration nominal(samples, Vec3::Zero(), Vec3::Zero(), slow);
  const Preintegration lossy(samples, Vec3::Zero(), Vec3::Zero(), fast);
  EXPECT_LT(10.0 * nominal.covariance()(kTheta, kTheta), lossy.covariance()(kTheta, kTheta));
}

}  // namespace
}  // namespace lodeline

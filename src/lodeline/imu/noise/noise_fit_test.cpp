#include "lodeline/imu/noise/noise_fit.h"

#include <gtest/gtest.h>

#include "lodeline/imu/test_noise.h"

namespace lodeline {
namespace {

constexpr double kRate_hz = 50.0;

AllanCurve curveOf(TestNoise noise, int readings) {
  AllanAccumulator accumulator;
  for (int i = 0; i < readings; ++i) accumulator.add(noise.next());
  return accumulator.curve(1.0 / kRate_hz);
}

TEST(AllanCovariance, IsTheScatterOfManyRecords) {
  // White noise and random walk with equal deviations at 0.4 s.
  const double white = 1e-3, walk = 4e-3;
  constexpr int kRecords = 400, kReadings = 1024;
  std::vector<AllanPoint> points;
  std::vector<Eigen::VectorXd> records;
  for (unsigned record = 0; record < kRecords; ++record) {
    const AllanCurve curve = curveOf(TestNoise(white, 0.0, walk, kRate_hz, 100 + record), kReadings);
    points.clear();
    Eigen::VectorXd variance(5);
    for (const AllanPoint& point : curve.points) {
      for (const int64_t factor : {2, 16, 64, 128, 256}) {
        if (point.factor != factor) continue;
        variance[static_cast<Eigen::Index>(points.size())] = point.variance.x();
        points.push_back(point);
      }
    }
    records.push_back(variance);
  }
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(5);
  for (const auto& record : records) mean += record / kRecords;
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(5, 5);
  for (const auto& record : records)
    scatter += (record - mean) * (record - mean).transpose() / (kRecords - 1);
  const AllanCovariance covariance(points, 1.0 / kRate_hz, kReadings / kRate_hz);
  const Eigen::MatrixXd predicted = covariance({0.0, white * white, 0.0, walk * walk});
  for (int i = 0; i < 5; ++i) {
    // The relative error of a sample variance of 400 normal values is 7 %. The distributions at long times
    // have longer tails.
    EXPECT_NEAR(scatter(i, i) / predicted(i, i), 1.0, 0.3) << points[static_cast<size_t>(i)].factor;
    for (int j = i + 1; j < 5; ++j) {
      const double scale = std::sqrt(predicted(i, i) * predicted(j, j));
      EXPECT_NEAR(scatter(i, j) / scale, predicted(i, j) / scale, 0.2) << i << " " << j;
    }
  }
}

TEST(FlickerShare, RisesFromNothingToOneAroundItsCorner) {
  EXPECT_DOUBLE_EQ(flickerShare(0.3, 0.0), 1.0);
  EXPECT_LT(flickerShare(0.01, 1.0), 0.05);
  EXPECT_NEAR(flickerShare(100.0, 1.0), 1.0, 0.02);
  double last = 0.0;
  for (double tau_s = 0.01; tau_s < 100.0; tau_s *= 2.0) {
    EXPECT_GT(flickerShare(tau_s, 1.0), last);
    last = flickerShare(tau_s, 1.0);
  }
}

TEST(NoiseFit, FindsWhiteNoiseInstabilityAndWalk) {
  const double white = 1e-3, instability = 1e-3, walk = 1e-4;
  int walks_within = 0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const auto fit =
        fitNoise(curveOf(TestNoise(white, instability, walk, kRate_hz, seed), 300000), std::nullopt);
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->white.value, white, 0.03 * white) << seed;
    EXPECT_NEAR(fit->instability.value, instability, 0.15 * instability) << seed;
    walks_within += std::abs(fit->walk.value - walk) < 0.35 * walk ? 1 : 0;
    EXPECT_EQ(fit->ramp.value, 0.0) << seed;
    EXPECT_FALSE(fit->is_filtered);
    EXPECT_LT(fit->misfit, 3.0) << seed;
  }
  EXPECT_GE(walks_within, 3);
}

TEST(NoiseFit, ClaimsTheUncertaintyItHas) {
  const double white = 1e-3, walk = 1e-3;
  double white_error = 0.0, walk_error = 0.0;
  constexpr int kSeeds = 30;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const auto fit = fitNoise(curveOf(TestNoise(white, 0.0, walk, kRate_hz, seed), 20000), 0);
    ASSERT_TRUE(fit && fit->white.resolved && fit->walk.resolved) << seed;
    white_error += std::pow((fit->white.value - white) / fit->white.sigma, 2) / kSeeds;
    walk_error += std::pow((fit->walk.value - walk) / fit->walk.sigma, 2) / kSeeds;
  }
  // One if exact; the model error makes the uncertainty of the white noise conservative.
  EXPECT_GT(white_error, 0.2);
  EXPECT_LT(white_error, 1.9);
  EXPECT_GT(walk_error, 0.4);
  EXPECT_LT(walk_error, 1.9);
}

TEST(NoiseFit, ClaimsNothingThatIsNotThere) {
  int claims = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const auto fit = fitNoise(curveOf(TestNoise(1e-3, 0.0, 0.0, kRate_hz, seed), 50000), std::nullopt);
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->white.value, 1e-3, 1e-5) << seed;
    claims += (fit->walk.resolved ? 1 : 0) + (fit->instability.resolved ? 1 : 0);
    EXPECT_LT(fit->walk.value, fit->walk.at_most);
    EXPECT_GT(fit->walk.at_most, 0.0);
  }
  EXPECT_LE(claims, 1);
}

TEST(NoiseFit, KeepsAxesApart) {
  TestNoise noise(1e-3, 0.0, 0.0, kRate_hz, 5);
  AllanAccumulator accumulator;
  for (int i = 0; i < 50000; ++i) accumulator.add(noise.next().cwiseProduct(Vec3(1.0, 2.0, 4.0)));
  const AllanCurve curve = accumulator.curve(1.0 / kRate_hz);
  for (int axis = 0; axis < 3; ++axis) {
    const double white = 1e-3 * std::pow(2.0, axis);
    EXPECT_NEAR(fitNoise(curve, axis)->white.value, white, 0.02 * white);
  }
  EXPECT_NEAR(fitNoise(curve, std::nullopt)->white.value, 1e-3 * std::sqrt(21.0 / 3.0), 5e-5);
}

TEST(NoiseFit, SeesASteadyDrift) {
  TestNoise noise(1e-3, 0.0, 0.0, kRate_hz, 6);
  AllanAccumulator accumulator;
  for (int i = 0; i < 100000; ++i) accumulator.add(noise.next() + Vec3::Constant(1e-6 * i / kRate_hz));
  const auto fit = fitNoise(accumulator.curve(1.0 / kRate_hz), std::nullopt);
  EXPECT_NEAR(fit->ramp.value, 1e-6, 0.1e-6);
  EXPECT_NEAR(fit->white.value, 1e-3, 0.02e-3);
}

TEST(NoiseFit, LeavesOutWhatALowPassFilterHides) {
  TestNoise noise(1e-3, 0.0, 0.0, kRate_hz, 7);
  AllanAccumulator accumulator;
  Vec3 filtered = Vec3::Zero();
  for (int i = 0; i < 200000; ++i) {
    filtered += 0.1 * (noise.next() - filtered);
    accumulator.add(filtered);
  }
  const auto fit = fitNoise(accumulator.curve(1.0 / kRate_hz), std::nullopt);
  EXPECT_TRUE(fit->is_filtered);
  EXPECT_GT(fit->shortest_s, 5.0 / kRate_hz);
  EXPECT_NEAR(fit->white.value, 1e-3, 0.06e-3);
}

TEST(NoiseFit, DescribesItsCurveAndGivesFiltersTheInstabilityAsAWalk) {
  NoiseFit fit;
  fit.white.value = 2.0;
  fit.instability.value = 3.0;
  fit.walk.value = 0.5;
  const double flicker = 9.0 * 2.0 * std::numbers::ln2 / std::numbers::pi;
  EXPECT_NEAR(fit.variance(10.0), 0.4 + flicker + 0.25 * 10.0 / 3.0, 1e-12);
  const double walk = fit.walkWithInstability(100.0);
  EXPECT_NEAR(walk * walk * 100.0 / 3.0, flicker + 0.25 * 100.0 / 3.0, 1e-9);
}

TEST(NoiseFit, HasNoAnswerForShortOrSilentRecords) {
  EXPECT_FALSE(fitNoise(curveOf(TestNoise(1e-3, 0.0, 0.0, kRate_hz, 1), 100), 0));
  AllanAccumulator silent;
  for (int i = 0; i < 5000; ++i) silent.add(Vec3(1.0, 2.0, 3.0));
  EXPECT_FALSE(fitNoise(silent.curve(1.0 / kRate_hz), 0));
}

}  // namespace
}  // namespace lodeline

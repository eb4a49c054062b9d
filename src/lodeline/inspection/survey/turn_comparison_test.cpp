#include "lodeline/inspection/survey/turn_comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lodeline/geometry/so3.h"
#include "lodeline/inspection/survey/signed_axes.h"
#include "lodeline/inspection/survey/visual_rotation.h"

namespace lodeline {
namespace {

Vec3 rateAt(double t) {
  return {0.3 * std::sin(1.7 * t), 0.25 * std::sin(2.3 * t + 1.0), 0.35 * std::sin(1.1 * t + 2.0)};
}

const Quat kBodyFromCamera(Eigen::AngleAxisd(1.2, Vec3(0.3, -0.8, 0.5).normalized()));

/// Ten seconds of gyroscope readings at 200 Hz that are `axes` times the true rates.
std::vector<ImuSample> gyroscope(const Mat3& axes = Mat3::Identity()) {
  std::vector<ImuSample> samples;
  for (int i = 0; i < 2000; ++i) {
    const double t = 0.005 * i;
    samples.push_back(
        {Time::fromSeconds(t), Vec3(axes * rateAt(t) + Vec3(0.02, -0.01, 0.03)), Vec3::UnitZ()});
  }
  return samples;
}

/// Rotations at 20 Hz with stamps late by `delay_s`, with noise.
std::vector<CameraTurn> turns(double delay_s, const Quat& body_from_camera = kBodyFromCamera,
                              double focal_ratio = 1.0) {
  std::vector<CameraTurn> result;
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 0.01);
  for (int i = 10; i < 180; ++i) {
    const double t = 0.05 * i;
    Vec3 rate_C = body_from_camera.conjugate() * rateAt(t + 0.025);
    rate_C.head<2>() *= focal_ratio;
    result.push_back({Time::fromSeconds(t + delay_s), Time::fromSeconds(t + 0.05 + delay_s),
                      rate_C + Vec3(noise(random), noise(random), noise(random))});
  }
  return result;
}

TEST(TurnComparison, FindsNothingWhereAllIsRight) {
  const auto comparison = compareTurns(turns(0.0), GyroscopeIntegral(gyroscope()), kBodyFromCamera);
  ASSERT_TRUE(comparison);
  EXPECT_GT(comparison->correlation, 0.99);
  EXPECT_NEAR(comparison->time_offset_s, 0.0, 2e-3);
  EXPECT_LT(comparison->misalignment_rad, 0.01);
  EXPECT_NEAR(comparison->focal_ratio, 1.0, 0.01);
  EXPECT_NEAR(comparison->gyroscope_scale, 1.0, 0.02);
  EXPECT_EQ(comparison->hidden_axes, 0);
  EXPECT_FALSE(comparison->is_mirrored);
}

TEST(TurnComparison, FindsTheTimeOffset) {
  for (const double delay_s : {-0.3, -0.02, 0.005, 0.02, 0.8}) {
    const auto comparison = compareTurns(turns(delay_s), GyroscopeIntegral(gyroscope()), kBodyFromCamera);
    ASSERT_TRUE(comparison);
    EXPECT_NEAR(comparison->time_offset_s, -delay_s, 2e-3);
    EXPECT_LT(comparison->time_offset_sigma_s, 2e-3);
  }
}

TEST(TurnComparison, FindsATimeOffsetOfSeconds) {
  std::vector<ImuSample> samples;
  for (int i = -1000; i < 3000; ++i) {
    const double t = 0.005 * i;
    // Without a period, so that no other offset fits.
    samples.push_back({Time::fromSeconds(t), rateAt(t + 0.02 * t * t), Vec3::UnitZ()});
  }
  for (const double delay_s : {-2.5, 1.25, 4.2}) {
    std::vector<CameraTurn> late = turns(delay_s);
    for (CameraTurn& turn : late) {
      const double t = (turn.begin - Time::fromSeconds(delay_s)).seconds() + 0.025;
      turn.rate_C = kBodyFromCamera.conjugate() * rateAt(t + 0.02 * t * t);
    }
    const auto comparison = compareTurns(late, GyroscopeIntegral(samples), kBodyFromCamera);
    ASSERT_TRUE(comparison);
    EXPECT_GT(comparison->correlation, 0.99);
    EXPECT_NEAR(comparison->time_offset_s, -delay_s, 3e-3);
  }
}

TEST(TurnComparison, FindsTheRotation) {
  const Vec3 error_B(0.1, -0.05, 0.12);
  const auto comparison = compareTurns(turns(0.0, so3::exp(error_B) * kBodyFromCamera),
                                       GyroscopeIntegral(gyroscope()), kBodyFromCamera);
  ASSERT_TRUE(comparison);
  EXPECT_NEAR(comparison->misalignment_rad, error_B.norm(), 0.01);
}

/// Rotations with errors that last for half a second, as translations and passing fish cause them.
std::vector<CameraTurn> turnsWithLastingErrors(uint32_t seed, const Quat& body_from_camera) {
  constexpr double kSigma_rad_per_s = 0.08, kKept = 0.9;  // of one rotation's error in the next
  std::vector<CameraTurn> result = turns(0.0, body_from_camera);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, kSigma_rad_per_s);
  Vec3 error(normal(random), normal(random), normal(random));
  for (CameraTurn& turn : result) {
    turn.rate_C += error;
    error =
        kKept * error + std::sqrt(1.0 - kKept * kKept) * Vec3(normal(random), normal(random), normal(random));
  }
  return result;
}

TEST(TurnComparison, TakesNoLastingErrorsForARotation) {
  constexpr int kRuns = 15;
  int wrong = 0, found = 0;
  for (uint32_t seed = 1; seed <= kRuns; ++seed) {
    const auto misalignment_rad = [&](double error_rad) {
      const Quat turned = so3::exp(Vec3(0.0, error_rad, 0.0)) * kBodyFromCamera;
      return compareTurns(turnsWithLastingErrors(seed, turned), GyroscopeIntegral(gyroscope()),
                          kBodyFromCamera)
          .value()
          .misalignment_rad;
    };
    wrong += misalignment_rad(0.0) > 0.0;
    found += misalignment_rad(0.6) > 0.3;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GE(found, kRuns - 1);
}

TEST(TurnComparison, FindsEveryExchangeOfAxesAndMirrors) {
  for (const Mat3& axes : signedAxes()) {
    const auto comparison = compareTurns(turns(0.0), GyroscopeIntegral(gyroscope(axes)), kBodyFromCamera);
    ASSERT_TRUE(comparison);
    EXPECT_EQ(comparison->is_mirrored, axes.determinant() < 0.0);
    EXPECT_LT((nearestSignedAxes(comparison->axes) - axes.transpose()).norm(), 1e-9);
  }
}

TEST(TurnComparison, FindsTheFocalLength) {
  const auto comparison =
      compareTurns(turns(0.0, kBodyFromCamera, 0.8), GyroscopeIntegral(gyroscope()), kBodyFromCamera);
  ASSERT_TRUE(comparison);
  EXPECT_NEAR(comparison->focal_ratio, 0.8, 0.02);
}

TEST(TurnComparison, SaysNothingOfACameraThatHardlyTurns) {
  std::vector<CameraTurn> still = turns(0.0);
  for (CameraTurn& turn : still) turn.rate_C *= 0.01;
  EXPECT_FALSE(compareTurns(still, GyroscopeIntegral(gyroscope()), kBodyFromCamera));
}

/// Rays of 150 points at 1.5 to 4.5 m; one of every `outlier_every` is wrong.
void makeRays(int outlier_every, const Quat& rotation, const Vec3& translation, std::vector<Vec3>* before,
              std::vector<Vec3>* after) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < 150; ++i) {
    const double x = 0.8 * uniform(random);
    const double y = 0.6 * uniform(random);
    const Vec3 point = Vec3(x, y, 1.0) * (3.0 + 1.5 * uniform(random));
    const Vec3 elsewhere(y, x, 1.0);
    before->push_back((rotation * point + translation).normalized());
    after->push_back(i % outlier_every == 0 ? elsewhere.normalized() : point.normalized());
  }
}

TEST(VisualRotation, DoesNotTakeTranslationForRotation) {
  const Quat rotation = so3::exp(Vec3(0.01, -0.02, 0.015));
  std::vector<Vec3> before, after;
  makeRays(1000, rotation, Vec3(0.05, -0.02, 0.03), &before, &after);
  const auto estimate = visualRotation(before, after);
  ASSERT_TRUE(estimate);
  EXPECT_LT((estimate->rotation_C - so3::log(rotation)).norm(), 1e-4);
  EXPECT_GE(estimate->points, 149);
  before.resize(10);
  after.resize(10);
  EXPECT_FALSE(visualRotation(before, after));
}

TEST(VisualRotation, BearsOutliers) {
  const Quat rotation = so3::exp(Vec3(0.01, -0.02, 0.015));
  std::vector<Vec3> before, after;
  makeRays(8, rotation, Vec3(0.05, -0.02, 0.03), &before, &after);
  const auto estimate = visualRotation(before, after);
  ASSERT_TRUE(estimate);
  // Translation alone gives a flow of 0.02 rad here.
  EXPECT_LT((estimate->rotation_C - so3::log(rotation)).norm(), 7e-3);
  EXPECT_GE(estimate->points, 125);
}

}  // namespace
}  // namespace lodeline

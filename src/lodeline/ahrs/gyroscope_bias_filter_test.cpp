#include "lodeline/ahrs/gyroscope_bias_filter.h"

#include <gtest/gtest.h>

#include "lodeline/ahrs/rest_detector.h"

namespace lodeline {
namespace {

constexpr double kStep_s = 0.01;

TEST(GyroscopeBiasFilter, LearnsTheMeanAtRest) {
  GyroscopeBiasFilter filter({}, 3.0);
  const Vec3 bias(0.02, -0.03, 0.01);
  for (int i = 0; i < 500; ++i) EXPECT_TRUE(filter.updateAtRest(bias, kStep_s));
  EXPECT_LT((filter.bias_B() - bias).norm(), 1e-3);
  EXPECT_LT(std::sqrt(filter.covariance()(2, 2)), 1.5e-3);
}

TEST(GyroscopeBiasFilter, KnowsASlowTurnFromABiasOnceItKnowsTheBias) {
  GyroscopeBiasFilter filter({}, 3.0);
  for (int i = 0; i < 1000; ++i) filter.updateAtRest(Vec3::Zero(), kStep_s);
  const Vec3 pan(0.0, 0.0, 0.03);
  EXPECT_FALSE(filter.updateAtRest(pan, kStep_s));
  EXPECT_LT(filter.bias_B().norm(), 1e-9);
}

TEST(GyroscopeBiasFilter, TakesNoFastTurnForABias) {
  GyroscopeBiasFilter filter({}, 3.0);
  EXPECT_FALSE(filter.updateAtRest(Vec3(0.0, 0.0, 1.0), kStep_s));
}

TEST(GyroscopeBiasFilter, LearnsHorizontalPartsFromCorrectionsOfInclination) {
  // Level and without rotation; the accelerometer exactly undoes the effect of the bias.
  GyroscopeBiasFilter filter({}, 3.0);
  const Vec3 bias(0.01, -0.02, 0.03);
  for (int i = 0; i < 30000; ++i) {
    filter.follow(Mat3::Identity(), kStep_s);
    filter.updateInMotion(-(bias - filter.bias_B()) * kStep_s, kStep_s);
  }
  EXPECT_NEAR(filter.bias_B().x(), bias.x(), 1e-3);
  EXPECT_NEAR(filter.bias_B().y(), bias.y(), 1e-3);
  EXPECT_NEAR(filter.bias_B().z(), 0.0, 1e-9);
  EXPECT_GT(filter.covariance()(2, 2), 10.0 * filter.covariance()(0, 0));
}

TEST(RestDetector, NeedsCalmForAWhile) {
  RestDetector detector({});
  ImuSample sample;
  sample.specific_force_B = Vec3(0.0, 0.0, 9.8);
  for (int i = 0; i < 140; ++i) EXPECT_FALSE(detector.update(sample, kStep_s)) << i;
  for (int i = 0; i < 20; ++i) detector.update(sample, kStep_s);
  EXPECT_TRUE(detector.update(sample, kStep_s));
  sample.angular_velocity_B.x() = 0.2;
  EXPECT_FALSE(detector.update(sample, kStep_s));
}

}  // namespace
}  // namespace lodeline

#include "lodeline/imu/propagation.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "lodeline/imu/test_motion.h"

namespace lodeline {
namespace {

const Vec3 kGyroscopeBias(0.01, -0.02, 0.015);
const Vec3 kAccelerometerBias(-0.05, 0.1, 0.08);
const TestMotion kMotion;

TEST(Propagation, LeadsFromOneTrueStateToTheNext) {
  const auto samples = kMotion.readings(0.4, 0.9, 200.0, kGyroscopeBias, kAccelerometerBias);
  const Preintegration preintegration(samples, kGyroscopeBias, kAccelerometerBias, ImuCalibration());
  const NavigationState next =
      predict(kMotion.state(samples.front().time, kGyroscopeBias, kAccelerometerBias), preintegration,
              standardGravity_W());
  const NavigationState truth = kMotion.state(samples.back().time);
  EXPECT_EQ(next.time, samples.back().time);
  EXPECT_LT((next.world_from_body.translation - truth.world_from_body.translation).norm(), 1e-4);
  EXPECT_LT(so3::log(next.world_from_body.rotation.conjugate() * truth.world_from_body.rotation).norm(),
            5e-5);
  EXPECT_LT((next.velocity_W - truth.velocity_W).norm(), 1e-4);
  EXPECT_EQ(next.gyroscope_bias_B, kGyroscopeBias);
  EXPECT_EQ(next.accelerometer_bias_B, kAccelerometerBias);
}

TEST(Propagation, UsesTheStatesOwnBiases) {
  const auto samples = kMotion.readings(0.4, 0.5, 200.0, kGyroscopeBias, kAccelerometerBias);
  // Integrated with biases of zero: predict() must correct for the state's biases.
  const Preintegration preintegration(samples, Vec3::Zero(), Vec3::Zero(), ImuCalibration());
  const NavigationState next =
      predict(kMotion.state(samples.front().time, kGyroscopeBias, kAccelerometerBias), preintegration,
              standardGravity_W());
  const NavigationState truth = kMotion.state(samples.back().time);
  EXPECT_LT((next.world_from_body.translation - truth.world_from_body.translation).norm(), 1e-5);
  EXPECT_LT((next.velocity_W - truth.velocity_W).norm(), 1e-4);
}

TEST(Propagation, AtRestStaysAtRest) {
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 200; ++i) {
    samples.push_back({Time::fromNanoseconds(i * 5'000'000), Vec3::Zero(), Vec3(0.0, 0.0, 9.80665)});
  }
  const Preintegration preintegration(samples, Vec3::Zero(), Vec3::Zero(), ImuCalibration());
  const NavigationState next = predict(NavigationState(), preintegration, standardGravity_W());
  EXPECT_LT(next.world_from_body.translation.norm(), 1e-12);
  EXPECT_LT(next.velocity_W.norm(), 1e-12);
}

TEST(Propagation, RefusesAStateOfAnotherMoment) {
  const Preintegration preintegration(kMotion.readings(0.4, 0.5, 200.0), Vec3::Zero(), Vec3::Zero(),
                                      ImuCalibration());
  EXPECT_THROW(predict(kMotion.state(Time::fromSeconds(0.41)), preintegration, standardGravity_W()),
               std::invalid_argument);
}

}  // namespace
}  // namespace lodeline

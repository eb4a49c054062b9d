#include "lodeline/estimator/initialization/visual_inertial_alignment.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>

#include "lodeline/imu/test_motion.h"

namespace lodeline {
namespace {

const Vec3 kGyroscopeBias(0.01, -0.02, 0.015);
const Vec3 kCamera_B(0.05, 0.02, -0.03);
const Quat kVisualFromWorld = so3::exp(Vec3(0.4, -1.2, 0.7));
constexpr double kMetresPerUnit = 0.37;

// Exact visual structure of arbitrary scale and attitude with simulated intervals.
struct Case {
  std::vector<Quat> rotations;
  std::vector<Vec3> camera_positions;
  std::vector<std::unique_ptr<Preintegration>> owned;
  std::vector<Preintegration*> intervals;
  std::vector<Vec3> velocities_W;

  using Readings = std::function<std::vector<ImuSample>(double from_s, double to_s)>;
  using State = std::function<NavigationState(Time)>;
  Case(const Readings& readings, const State& state, const Vec3& assumed_gyroscope_bias) {
    constexpr int kFrames = 12;
    constexpr double kInterval_s = 0.15;
    for (int k = 0; k < kFrames; ++k) {
      const NavigationState truth = state(Time::fromSeconds(k * kInterval_s));
      rotations.push_back(kVisualFromWorld * truth.world_from_body.rotation);
      camera_positions.push_back(kVisualFromWorld * (truth.world_from_body * kCamera_B) / kMetresPerUnit);
      velocities_W.push_back(truth.velocity_W);
      if (k == 0) continue;
      owned.push_back(std::make_unique<Preintegration>(readings((k - 1) * kInterval_s, k * kInterval_s),
                                                       assumed_gyroscope_bias, Vec3::Zero(),
                                                       ImuCalibration{}));
      intervals.push_back(owned.back().get());
    }
  }
  std::optional<VisualInertialAlignment> align(double bias_sigma_m_per_s2 = 0.2,
                                               const MeasuredVelocities& measured = {}) const {
    return alignVisualInertial(rotations, camera_positions, kCamera_B, intervals, kStandardGravity,
                               bias_sigma_m_per_s2, measured);
  }
};

Case lively(const Vec3& accelerometer_bias, const Vec3& assumed_gyroscope_bias) {
  const TestMotion motion;
  return Case(
      [&](double from_s, double to_s) {
        return motion.readings(from_s, to_s, 400.0, kGyroscopeBias, accelerometer_bias);
      },
      [&](Time time) { return motion.state(time); }, assumed_gyroscope_bias);
}

TEST(GyroscopeBiasAlignment, FindsTheBias) {
  const Case c = lively(Vec3::Zero(), Vec3::Zero());
  const Vec3 bias = alignGyroscopeBias(c.rotations, c.intervals);
  // The rest is the integration error at 400 Hz.
  EXPECT_LT((bias - kGyroscopeBias).norm(), 1e-5);
  for (const Preintegration* interval : c.intervals) EXPECT_EQ(interval->gyroscopeBias(), bias);
}

TEST(VisualInertialAlignment, FindsScaleGravityAndVelocities) {
  const Case c = lively(Vec3::Zero(), kGyroscopeBias);
  const auto alignment = c.align();
  ASSERT_TRUE(alignment.has_value());
  EXPECT_NEAR(alignment->scale, kMetresPerUnit, 1e-3 * kMetresPerUnit);
  EXPECT_LT((alignment->gravity_V - kVisualFromWorld * standardGravity_W()).norm(), 0.01);
  EXPECT_NEAR(alignment->gravity_V.norm(), kStandardGravity, 1e-9);
  EXPECT_NEAR(alignment->free_gravity_magnitude, kStandardGravity, 0.02);
  ASSERT_EQ(alignment->velocities_V.size(), c.velocities_W.size());
  for (size_t k = 0; k < c.velocities_W.size(); ++k)
    EXPECT_LT((alignment->velocities_V[k] - kVisualFromWorld * c.velocities_W[k]).norm(), 0.01) << k;
}

TEST(VisualInertialAlignment, FindsTheAccelerometersBiasFromAnyPresumedOne) {
  const Vec3 bias(0.36, -0.30, 0.36);
  const Case c = lively(bias, kGyroscopeBias);
  for (const Vec3& presumed : {Vec3(0.0, 0.0, 0.0), Vec3(0.2, 0.1, -0.3)}) {
    for (Preintegration* interval : c.intervals) interval->repropagate(kGyroscopeBias, presumed);
    const auto alignment = c.align(10.0);
    ASSERT_TRUE(alignment.has_value());
    EXPECT_LT((alignment->accelerometer_bias_B - bias).norm(), 0.01);
    EXPECT_NEAR(alignment->scale, kMetresPerUnit, 1e-3 * kMetresPerUnit);
    EXPECT_LT((alignment->gravity_V - kVisualFromWorld * standardGravity_W()).norm(), 0.01);
  }
}

// Over less than two seconds, gravity and the bias are hardly distinguishable.
TEST(VisualInertialAlignment, LeavesTheBiasToItsPriorWhereMotionSaysLittleOfIt) {
  const Case c = lively(Vec3(0.36, -0.30, 0.36), kGyroscopeBias);
  const auto alignment = c.align(1e-3);
  ASSERT_TRUE(alignment.has_value());
  EXPECT_LT(alignment->accelerometer_bias_B.norm(), 1e-3);
}

Case glide(const Vec3& velocity) {
  return Case(
      [](double from_s, double to_s) {
        std::vector<ImuSample> samples;
        for (int i = 0; i <= 30; ++i)
          samples.push_back({Time::fromSeconds(from_s + (to_s - from_s) * i / 30.0), Vec3::Zero(),
                             Vec3(-standardGravity_W())});
        return samples;
      },
      [&](Time time) {
        NavigationState state;
        state.time = time;
        state.world_from_body.translation = velocity * time.seconds();
        state.velocity_W = velocity;
        return state;
      },
      Vec3::Zero());
}

TEST(VisualInertialAlignment, RefusesConstantVelocity) {
  EXPECT_FALSE(glide(Vec3(0.5, 0.2, 0.0)).align().has_value());
}

TEST(VisualInertialAlignment, FindsTheScaleOfConstantVelocityWhereThatIsMeasured) {
  const Vec3 velocity(0.5, 0.2, 0.0);
  const Case c = glide(velocity);
  MeasuredVelocities measured(c.rotations.size());
  // Measured a tenth of a second before the frame, and carried there without gravity.
  measured[4] = CarriedVelocity{velocity - 0.1 * standardGravity_W(), 0.1, 0.01};
  const auto alignment = c.align(0.2, measured);
  ASSERT_TRUE(alignment.has_value());
  EXPECT_NEAR(alignment->scale, kMetresPerUnit, 1e-3 * kMetresPerUnit);
  EXPECT_LT((alignment->gravity_V - kVisualFromWorld * standardGravity_W()).norm(), 0.01);
  for (const Vec3& velocity_V : alignment->velocities_V)
    EXPECT_LT((velocity_V - kVisualFromWorld * velocity).norm(), 1e-3);
}

}  // namespace
}  // namespace lodeline

#include "lodeline/frontend/stereo/stereo_delay.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lodeline/geometry/so3.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

constexpr double kDelayFocal_px = 450.0, kDelayNoise_px = 0.3;

/// Estimator after matches of a pair of cameras that sways and drifts in front of points at 1 to 8 m. The
/// second camera takes its images `delay_s` later than the first and is rotated by `turn_rad` about x
/// relative to its file. A share of the matches is wrong.
StereoDelay watched(double delay_s, double turn_rad, double sway_rad_per_s, double wrong_share = 0.1) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const Rigid3 second_from_first(so3::exp(Vec3(0.01, -0.02, 0.0)), Vec3(-0.11, 0.001, 0.002));
  const Rigid3 really(so3::exp(Vec3(turn_rad, 0.0, 0.0)) * second_from_first.rotation,
                      so3::exp(Vec3(turn_rad, 0.0, 0.0)) * second_from_first.translation);
  StereoDelay delay;
  for (int frame = 0; frame < 100; ++frame) {
    const double t_s = 0.05 * frame;
    const Vec3 rate_C =
        sway_rad_per_s * Vec3(std::sin(2.1 * t_s), std::sin(1.3 * t_s + 1.0), std::cos(1.7 * t_s));
    const Vec3 velocity_C(0.2, 0.1 * std::sin(t_s), 0.3);
    std::vector<RayPair> pairs;
    for (int i = 0; i < 80; ++i) {
      const double depth_m = 4.5 + 3.5 * uniform(random);
      const Vec3 point_C1 = depth_m * Vec3(0.6 * uniform(random), 0.4 * uniform(random), 1.0);
      // The second camera moves on before it takes its image.
      const Vec3 at_first = really * point_C1;
      const Vec3 at_second = so3::exp(Vec3(-rate_C * delay_s)) * (at_first - velocity_C * delay_s);
      Vec3 ray = at_second / at_second.z();
      const bool is_wrong = uniform(random) < -1.0 + 2.0 * wrong_share;
      for (int axis = 0; axis < 2; ++axis)
        ray[axis] += (is_wrong ? 8.0 : kDelayNoise_px) * normal(random) / kDelayFocal_px;
      pairs.push_back({point_C1.normalized(), ray.normalized()});
    }
    delay.add(pairs, second_from_first, kDelayFocal_px, rate_C, velocity_C);
  }
  return delay;
}

TEST(StereoDelay, FindsHowMuchLaterTheSecondCameraIs) {
  for (const double delay_s : {0.008, 0.017, 0.05, -0.012}) {
    const auto found = watched(delay_s, 0.0, 0.3).estimate();
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->delay_s, delay_s, 0.001 + 0.05 * std::abs(delay_s)) << delay_s;
    EXPECT_LT(found->sigma_s, 0.002);
  }
}

TEST(StereoDelay, FindsNoneWhereThereIsNone) {
  const auto found = watched(0.0, 0.0, 0.3).estimate();
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->delay_s, 0.0, 0.0007);
}

TEST(StereoDelay, ATurnedCameraIsNoDelay) {
  const auto found = watched(0.0, 0.4 * kDegree, 0.3).estimate();
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->delay_s, 0.0, 0.001);
}

TEST(StereoDelay, IsVagueWithoutMotion) {
  StereoDelay resting;
  const Rigid3 second_from_first(Quat::Identity(), Vec3(-0.1, 0.0, 0.0));
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int frame = 0; frame < 100; ++frame) {
    std::vector<RayPair> pairs;
    for (int i = 0; i < 60; ++i) {
      const Vec3 ray(0.3 * normal(random), 0.3 * normal(random), 1.0);
      pairs.push_back({ray.normalized(), (ray + Vec3(-0.02, 0.0007 * normal(random), 0.0)).normalized()});
    }
    resting.add(pairs, second_from_first, kDelayFocal_px, Vec3::Constant(1e-4), Vec3::Zero());
  }
  const auto found = resting.estimate();
  ASSERT_TRUE(found);
  EXPECT_GT(found->sigma_s, 0.02);
  EXPECT_LT(std::abs(found->delay_s), 6.0 * found->sigma_s);
}

TEST(StereoDelay, SaysNothingBeforeItHasSeenEnough) {
  StereoDelay delay;
  EXPECT_FALSE(delay.estimate());
  delay = watched(0.008, 0.0, 0.3);
  delay.restart();
  EXPECT_FALSE(delay.estimate());
}

}  // namespace
}  // namespace lodeline

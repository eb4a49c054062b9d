#include "lodeline/frontend/stereo/stereo_rotation.h"

#include <gtest/gtest.h>

#include <random>

#include "lodeline/geometry/so3.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

constexpr double kFocal_px = 450.0, kLimit_px = 2.0;

// Points in front of a pair with a baseline of 12 cm and a small rotation.
class StereoRotationTest : public testing::Test {
 protected:
  std::mt19937 random_{1};
  Rigid3 by_file_{so3::exp(Vec3(0.01, 0.02, -0.01)), Vec3(-0.12, 0.002, 0.001)};
  StereoRotation rotation_{by_file_, kFocal_px, kLimit_px};

  double uniform(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
  Vec3 noisy(const Vec3& ray, double sigma_px) {
    std::normal_distribution<double> normal(0.0, sigma_px / kFocal_px);
    return (ray / ray.z() + Vec3(normal(random_), normal(random_), 0.0)).normalized();
  }

  /// Matches of a pair whose second camera is rotated by `turn`; `wrong` of them are random.
  std::vector<RayPair> pairs(const Vec3& turn, int right, int wrong = 0) {
    std::vector<RayPair> pairs;
    const Quat rotation = so3::exp(turn);
    for (int i = 0; i < right + wrong; ++i) {
      const Vec3 first = Vec3(uniform(-0.6, 0.6), uniform(-0.45, 0.45), 1.0);
      const Vec3 second = rotation * (by_file_ * Vec3(uniform(1.0, 6.0) * first));
      const double sigma_px = i < right ? 0.3 : 10.0;
      pairs.push_back({first.normalized(), noisy(second, sigma_px)});
    }
    return pairs;
  }
};

TEST_F(StereoRotationTest, LeavesARightFileAlone) {
  for (int frame = 0; frame < 50; ++frame) rotation_.add(pairs(Vec3::Zero(), 100, 40));
  EXPECT_FALSE(rotation_.isFound());
  EXPECT_TRUE(rotation_.turn().isZero());
}

TEST_F(StereoRotationTest, FindsATurnAcrossThePlanesAtOnce) {
  const Vec3 turn(0.8 * kDegree, 0.0, -0.5 * kDegree);
  rotation_.add(pairs(turn, 100, 40));
  ASSERT_TRUE(rotation_.isFound());
  EXPECT_NEAR(rotation_.turn().x(), turn.x(), 0.02 * kDegree);
  EXPECT_NEAR(rotation_.turn().z(), turn.z(), 0.05 * kDegree);
  for (int frame = 0; frame < 20; ++frame) rotation_.add(pairs(turn, 100, 40));
  EXPECT_NEAR(rotation_.turn().x(), turn.x(), 0.01 * kDegree);
}

TEST_F(StereoRotationTest, SaysNothingOfATurnThatLooksLikeDepth) {
  for (int frame = 0; frame < 20; ++frame) rotation_.add(pairs(Vec3(0.0, 0.8 * kDegree, 0.0), 100));
  EXPECT_FALSE(rotation_.isFound());
}

TEST_F(StereoRotationTest, TakesChanceForNothing) {
  for (int frame = 0; frame < 50; ++frame) rotation_.add(pairs(Vec3::Zero(), 0, 100));
  EXPECT_FALSE(rotation_.isFound());
}

TEST_F(StereoRotationTest, WaitsForEnoughMatches) {
  for (int frame = 0; frame < 5; ++frame) rotation_.add(pairs(Vec3(0.8 * kDegree, 0.0, 0.0), 10));
  EXPECT_FALSE(rotation_.isFound());
  rotation_.add(pairs(Vec3(0.8 * kDegree, 0.0, 0.0), 10));
  EXPECT_TRUE(rotation_.isFound());
}

TEST_F(StereoRotationTest, HasNoPlanesWhereBothCamerasAreAtOnePlace) {
  StereoRotation rotation(Rigid3(by_file_.rotation, Vec3::Zero()), kFocal_px, kLimit_px);
  rotation.add(pairs(Vec3(0.8 * kDegree, 0.0, 0.0), 100));
  EXPECT_FALSE(rotation.isFound());
}

}  // namespace
}  // namespace lodeline

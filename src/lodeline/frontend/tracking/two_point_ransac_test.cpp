#include "lodeline/frontend/tracking/two_point_ransac.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "lodeline/geometry/so3.h"
#include "lodeline/types.h"

namespace lodeline {
namespace {

constexpr double kFocalPx = 458.0;
constexpr size_t kPoints = 200;

struct Pairs {
  std::vector<Vec3> previous, current;
};

/// Points in front of a camera that moves by `previous_from_current`, with 0.3 px of noise.
Pairs pairsFor(const Rigid3& previous_from_current) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> across(-0.7, 0.7), depth(1.0, 6.0);
  std::normal_distribution<double> noise(0.0, 0.3 / kFocalPx);
  Pairs pairs;
  for (size_t i = 0; i < kPoints; ++i) {
    const Vec3 point = depth(random) * Vec3(across(random), across(random), 1.0);
    const Vec3 seen = (previous_from_current.inverse() * point).normalized();
    pairs.previous.push_back(point.normalized());
    pairs.current.push_back((seen + Vec3(noise(random), noise(random), 0.0)).normalized());
  }
  return pairs;
}

std::vector<bool> judge(const Pairs& pairs, const Quat& previous_from_current) {
  return twoPointRansac(pairs.previous, pairs.current, previous_from_current.conjugate().toRotationMatrix(),
                        kFocalPx, {});
}

long count(const std::vector<bool>& agrees) { return std::count(agrees.begin(), agrees.end(), true); }

const Rigid3 kMotion(so3::exp(Vec3(0.02, -0.03, 0.01)), Vec3(0.04, 0.01, 0.02));

TEST(TwoPointRansac, KeepsGoodPairsAndRejectsOutliers) {
  Pairs pairs = pairsFor(kMotion);
  // A fifth of the points is displaced across its epipolar line.
  const Vec3 translation = kMotion.rotation.conjugate() * -kMotion.translation;
  for (size_t i = 0; i < kPoints; i += 5) {
    const Vec3 normal = translation.cross(kMotion.rotation.conjugate() * pairs.previous[i]).normalized();
    pairs.current[i] = (pairs.current[i] + 6.0 / kFocalPx * normal).normalized();
  }
  const std::vector<bool> agrees = judge(pairs, kMotion.rotation);
  for (size_t i = 0; i < kPoints; i += 5) EXPECT_FALSE(agrees[i]) << i;
  EXPECT_GE(count(agrees), 158);
}

TEST(TwoPointRansac, BearsAGyroscopeWithUnknownBias) {
  const Quat wrong = kMotion.rotation * so3::exp(Vec3(0.002, -0.004, 0.001));
  EXPECT_GE(count(judge(pairsFor(kMotion), wrong)), 198);
}

TEST(TwoPointRansac, RejectsNothingAtRestOrInPureRotation) {
  EXPECT_EQ(count(judge(pairsFor({}), Quat::Identity())), static_cast<long>(kPoints));
  const Rigid3 turn(so3::exp(Vec3(0.0, 0.08, 0.0)), Vec3::Zero());
  EXPECT_EQ(count(judge(pairsFor(turn), turn.rotation)), static_cast<long>(kPoints));
}

TEST(TwoPointRansac, BearsMotionAlongTheViewingDirection) {
  const Rigid3 forward(Quat::Identity(), Vec3(0.0, 0.0, 0.1));
  EXPECT_GE(count(judge(pairsFor(forward), Quat::Identity())), 198);
}

TEST(TwoPointRansac, DoesNotJudgeAHandfulAndRepeatsItself) {
  Pairs pairs = pairsFor(kMotion);
  EXPECT_EQ(judge(pairs, kMotion.rotation), judge(pairs, kMotion.rotation));
  pairs.previous.resize(5);
  pairs.current.assign(5, Vec3::UnitX());
  EXPECT_EQ(count(judge(pairs, kMotion.rotation)), 5);
  EXPECT_TRUE(judge({}, Quat::Identity()).empty());
}

}  // namespace
}  // namespace lodeline

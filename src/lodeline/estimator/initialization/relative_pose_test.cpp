#include "lodeline/estimator/initialization/relative_pose.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/geometry/so3.h"
#include "simulation/shared/random.h"

namespace lodeline {
namespace {

constexpr double kPixel_rad = 1.0 / 458.0;

struct Pairs {
  Rigid3 b_from_a{so3::exp(Vec3(0.05, -0.1, 0.08)), Vec3(-0.3, 0.05, 0.1)};
  double noise_rad = 0.0;
  double outlier_share = 0.0;
  bool planar = false;

  std::vector<BearingPair> make(int count) const {
    Random random(1, "pairs");
    std::vector<BearingPair> pairs;
    while (static_cast<int>(pairs.size()) < count) {
      const double x = random.uniform(-2.0, 2.0);
      const double y = random.uniform(-1.5, 1.5);
      const double z = planar ? 3.0 + 0.4 * x : random.uniform(2.0, 6.0);
      const Vec3 point_a(x, y, z);
      const Vec3 error = noise_rad * random.normal3();
      const bool outlier = random.chance(outlier_share);
      const Vec3 point_b =
          outlier ? Vec3(random.uniform(-2.0, 2.0), random.uniform(-1.5, 1.5), 4.0) : b_from_a * point_a;
      pairs.push_back({point_a.normalized(), (point_b.normalized() + error).normalized()});
    }
    return pairs;
  }
};

void expectPose(const std::optional<Rigid3>& found, const Rigid3& truth, double max_rotation_rad,
                double max_direction_rad) {
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(found->rotation.angularDistance(truth.rotation), max_rotation_rad);
  EXPECT_NEAR(found->translation.norm(), 1.0, 1e-9);
  EXPECT_LT(std::acos(std::min(1.0, found->translation.dot(truth.translation.normalized()))),
            max_direction_rad);
}

TEST(RelativePose, IsExactWithoutNoise) {
  const Pairs pairs;
  // The library's five-point solver is accurate to about 1e-6 where several samples agree equally well.
  expectPose(estimateRelativePose(pairs.make(100), kPixel_rad, 50), pairs.b_from_a, 1e-5, 1e-4);
}

TEST(RelativePose, SurvivesNoiseAndAThirdOfOutliers) {
  Pairs pairs;
  pairs.noise_rad = 0.5 * kPixel_rad;
  pairs.outlier_share = 0.33;
  // From the best five pairs: baseline over distance is 0.08, so half a pixel is 0.8 degrees in the direction
  // from one pair; several times that for a minimal sample.
  expectPose(estimateRelativePose(pairs.make(200), kPixel_rad, 80), pairs.b_from_a, 0.02, 0.25);
}

// Two views of a plane have two solutions (Longuet-Higgins, "The reconstruction of a plane surface from two
// perspective projections", 1986). The result may be either; more views must decide.
TEST(RelativePose, ExplainsTheViewsOfAPlane) {
  Pairs pairs;
  pairs.planar = true;
  pairs.noise_rad = 0.2 * kPixel_rad;
  const std::vector<BearingPair> views = pairs.make(150);
  const std::optional<Rigid3> found = estimateRelativePose(views, kPixel_rad, 75);
  ASSERT_TRUE(found.has_value());
  int agree = 0;
  for (const BearingPair& pair : views) {
    const Vec3 normal = found->translation.cross(found->rotation * pair.bearing_a).normalized();
    agree += std::abs(normal.dot(pair.bearing_b)) < 2.0 * kPixel_rad;
  }
  EXPECT_GT(agree, 140);
}

TEST(RelativePose, IsRefusedWhereTheViewsShareNoScene) {
  Pairs pairs;
  pairs.outlier_share = 1.0;
  EXPECT_FALSE(estimateRelativePose(pairs.make(100), kPixel_rad, 50).has_value());
  EXPECT_FALSE(estimateRelativePose(Pairs().make(5), kPixel_rad, 4).has_value());
  EXPECT_FALSE(estimateRelativePose({}, kPixel_rad, 20).has_value());
}

TEST(RelativePose, IsTheSameEveryTime) {
  Pairs pairs;
  pairs.noise_rad = 0.5 * kPixel_rad;
  const auto first = estimateRelativePose(pairs.make(100), kPixel_rad, 50);
  const auto second = estimateRelativePose(pairs.make(100), kPixel_rad, 50);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->rotation.coeffs(), second->rotation.coeffs());
  EXPECT_EQ(first->translation, second->translation);
}

TEST(Parallax, OfATurnAloneIsTheNoise) {
  Pairs pairs;
  pairs.b_from_a.translation.setZero();
  EXPECT_LT(parallaxAfterBestRotation(pairs.make(100)), 1e-9);
  pairs.noise_rad = kPixel_rad;
  // Median length of a two-dimensional normal error: 1.18 sigma.
  EXPECT_NEAR(parallaxAfterBestRotation(pairs.make(400)), 1.18 * kPixel_rad, 0.2 * kPixel_rad);
}

TEST(Parallax, OfAStepIsWhatNoRotationExplains) {
  // Points at one distance shift by the same angle, which the rotation compensates. Depths between 2 and 6 m
  // leave the spread of 0.3 m / z about its mean, about 20 mrad.
  Pairs pairs;
  const double parallax = parallaxAfterBestRotation(pairs.make(400));
  EXPECT_GT(parallax, 0.01);
  EXPECT_LT(parallax, 0.06);
  EXPECT_EQ(parallaxAfterBestRotation(pairs.make(2)), 0.0);
}

}  // namespace
}  // namespace lodeline

#include "lodeline/magnetometer/iron/ellipsoid_fit.h"

#include <gtest/gtest.h>

#include "lodeline/magnetometer/iron/test_cloud.h"

namespace lodeline {
namespace {

TEST(EllipsoidFit, FindsTheEllipsoidThatPointsLieOn) {
  const test::CloudTruth truth;
  const auto ellipsoid = fitEllipsoid(test::cloud(truth, 200));
  ASSERT_TRUE(ellipsoid);
  EXPECT_LT((ellipsoid->centre - truth.hard_iron).norm(), 1e-9);
  EXPECT_LT((ellipsoid->matrix - truth.correction).norm(), 1e-9);
  const Vec3 axes = ellipsoid->semiAxes();
  EXPECT_GE(axes[0], axes[1]);
  EXPECT_GE(axes[1], axes[2]);
}

TEST(EllipsoidFit, MovesAndScalesWithThePoints) {
  test::CloudTruth truth;
  truth.sigma = 0.02;
  const std::vector<Vec3> points = test::cloud(truth, 200);
  std::vector<Vec3> moved;
  const Vec3 shift(3000.0, -200.0, 70.0);
  for (const Vec3& p : points) moved.push_back(1000.0 * p + shift);
  const auto first = fitEllipsoid(points);
  const auto second = fitEllipsoid(moved);
  ASSERT_TRUE(first && second);
  EXPECT_LT((second->centre - (1000.0 * first->centre + shift)).norm(), 1e-6);
  EXPECT_LT((1000.0 * second->matrix - first->matrix).norm(), 1e-9);
}

TEST(EllipsoidFit, GivesNothingForPointsThatFillNoSpace) {
  std::vector<Vec3> plane, line, same(50, Vec3(1, 2, 3));
  for (int i = 0; i < 50; ++i) {
    plane.emplace_back(std::cos(0.3 * i), std::sin(0.3 * i), 2.0);
    line.emplace_back(i, 2 * i, 1.0);
  }
  for (const auto& points : {plane, line, same}) {
    EXPECT_FALSE(fitEllipsoid(points));
    EXPECT_FALSE(fitSphere(points));
  }
  EXPECT_FALSE(fitEllipsoid(test::cloud({}, 8)));
}

TEST(SphereFit, FindsCentreAndRadius) {
  test::CloudTruth truth;
  truth.correction = Mat3::Identity() / 3.0;
  const auto sphere = fitSphere(test::cloud(truth, 40));
  ASSERT_TRUE(sphere);
  EXPECT_LT((sphere->centre - truth.hard_iron).norm(), 1e-9);
  EXPECT_NEAR(sphere->semiAxes()[0], 3.0, 1e-9);
}

}  // namespace
}  // namespace lodeline

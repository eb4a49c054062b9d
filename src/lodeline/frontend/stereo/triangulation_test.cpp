#include "lodeline/frontend/stereo/triangulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

constexpr double kSigma = 1e-3;

std::vector<BearingView> viewsOf(const Vec3& point_W, int count, double baseline_m) {
  std::vector<BearingView> views;
  for (int i = 0; i < count; ++i) {
    BearingView view;
    view.world_from_camera = Rigid3(so3::exp(Vec3(0.02 * i, -0.03 * i, 0.1 * i)),
                                    Vec3(baseline_m * i, 0.02 * baseline_m * i * i, 0.0));
    view.bearing_C = (view.world_from_camera.inverse() * point_W).normalized();
    view.sigma_rad = kSigma;
    views.push_back(view);
  }
  return views;
}

void disturb(std::vector<BearingView>& views, std::mt19937& random) {
  std::normal_distribution<double> noise(0.0, kSigma);
  for (BearingView& view : views) {
    const Vec2 d(noise(random), noise(random));
    view.bearing_C = (view.bearing_C + tangentBasis(view.bearing_C) * d).normalized();
  }
}

TEST(Triangulation, RecoversAPointExactly) {
  const Vec3 point(0.4, -0.3, 3.0);
  for (const int count : {2, 3, 8}) {
    const Triangulation result = triangulate(viewsOf(point, count, 0.2));
    ASSERT_TRUE(result.good()) << toString(result.status);
    EXPECT_LT((result.point_W - point).norm(), 1e-9);
    EXPECT_NEAR(result.inverse_depth_per_m, 1.0 / point.norm(), 1e-10);
    EXPECT_LT(result.rms_sigmas, 1e-6);
  }
}

TEST(Triangulation, ReportsParallaxAndHonestUncertainty) {
  const Vec3 point(0.1, 0.2, 4.0);
  const std::vector<BearingView> clean = viewsOf(point, 5, 0.1);
  std::mt19937 random(3);
  double squared_error = 0.0, squared_sigma = 0.0, squared_residual = 0.0;
  constexpr int kTrials = 400;
  for (int i = 0; i < kTrials; ++i) {
    std::vector<BearingView> views = clean;
    disturb(views, random);
    const Triangulation result = triangulate(views);
    EXPECT_NEAR(result.max_parallax_rad, 0.1, 0.02);
    const double error = result.inverse_depth_per_m - 1.0 / point.norm();
    squared_error += error * error;
    squared_sigma += result.inverse_depth_sigma_per_m * result.inverse_depth_sigma_per_m;
    squared_residual += result.rms_sigmas * result.rms_sigmas;
  }
  EXPECT_NEAR(squared_error / squared_sigma, 1.0, 0.2);
  // Ten components minus three parameters.
  EXPECT_NEAR(squared_residual / kTrials, 0.7, 0.05);
}

TEST(Triangulation, SaysWhenRaysAreParallel) {
  const Triangulation far = triangulate(viewsOf(Vec3(0.0, 0.0, 500.0), 3, 0.1));
  EXPECT_EQ(far.status, TriangulationStatus::LowParallax);
  EXPECT_NEAR(far.inverse_depth_per_m, 0.002, 1e-6);
  EXPECT_GT(far.inverse_depth_sigma_per_m, 0.002);

  const Triangulation rotation_only = triangulate(viewsOf(Vec3(0.3, 0.0, 2.0), 4, 0.0));
  EXPECT_EQ(rotation_only.status, TriangulationStatus::LowParallax);
  EXPECT_TRUE(std::isfinite(rotation_only.inverse_depth_per_m));
  EXPECT_GT(rotation_only.inverse_depth_sigma_per_m, 100.0);
}

TEST(Triangulation, RefusesPointsBehindTheCamera) {
  std::vector<BearingView> views = viewsOf(Vec3(0.0, 0.0, -2.0), 3, 0.2);
  for (BearingView& view : views) view.bearing_C = -view.bearing_C;
  EXPECT_EQ(triangulate(views).status, TriangulationStatus::BehindCamera);
}

TEST(Triangulation, RefusesRaysThatDoNotMeet) {
  std::vector<BearingView> views = viewsOf(Vec3(0.2, 0.1, 2.0), 5, 0.2);
  views[2].bearing_C = (views[2].bearing_C + Vec3(0.0, 0.1, 0.0)).normalized();
  EXPECT_EQ(triangulate(views).status, TriangulationStatus::Inconsistent);
}

TEST(Triangulation, NeedsTwoViews) {
  EXPECT_EQ(triangulate({}).status, TriangulationStatus::TooFewViews);
  EXPECT_EQ(triangulate(viewsOf(Vec3(0.0, 0.0, 2.0), 1, 0.1)).status, TriangulationStatus::TooFewViews);
}

}  // namespace
}  // namespace lodeline

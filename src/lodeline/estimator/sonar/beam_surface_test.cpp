#include "lodeline/estimator/sonar/beam_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lodeline {
namespace {

/// Points of the plane with normal n through the beam at `range_m`, at directions on a spiral.
std::vector<BeamPoint> pointsOnPlane(const Vec3& normal, double range_m, int count = 9) {
  std::vector<BeamPoint> points;
  for (int i = 0; i < count; ++i) {
    const double radius = 0.02 * (i + 1);
    const Vec3 ray(1.0, radius * std::cos(2.0 * i), radius * std::sin(2.0 * i));
    const double distance_m = range_m * normal.x() / normal.dot(ray);
    points.push_back({ray.y(), ray.z(), 1.0 / distance_m, 1.0 / (1.0 + i)});
  }
  return points;
}

TEST(BeamSurface, MeetsAnInclinedPlaneExactly) {
  for (const Vec3& normal : {Vec3(1.0, 0.0, 0.0), Vec3(1.0, 1.5, -0.7), Vec3(0.3, -0.8, 0.4)}) {
    const BeamSurface surface(pointsOnPlane(normal, 3.2));
    EXPECT_NEAR(1.0 / surface.inverseDistance_per_m(), 3.2, 1e-6);
    EXPECT_NEAR(surface.scatter_per_m(), 0.0, 1e-7);
  }
}

TEST(BeamSurface, HasTheDerivativesOfItsDistance) {
  std::vector<BeamPoint> points = pointsOnPlane(Vec3(1.0, 0.6, -0.4), 2.0);
  for (size_t i = 0; i < points.size(); ++i) points[i].inverse_distance_per_m += 0.03 * std::sin(5.0 * i);
  const BeamSurface surface(points);
  constexpr double kStep = 1e-6;
  for (size_t i = 0; i < points.size(); ++i) {
    Vec3 numeric;
    for (int k = 0; k < 3; ++k) {
      const auto at = [&](double step) {
        std::vector<BeamPoint> moved = points;
        (k == 0 ? moved[i].across_1 : k == 1 ? moved[i].across_2 : moved[i].inverse_distance_per_m) += step;
        return BeamSurface(moved).inverseDistance_per_m();
      };
      numeric[k] = (at(kStep) - at(-kStep)) / (2.0 * kStep);
    }
    EXPECT_LT((surface.derivatives(i) - numeric).norm(), 1e-7) << "point " << i;
  }
}

TEST(BeamSurface, LeverageIsTheVarianceOfTheDistance) {
  const BeamSurface surface(pointsOnPlane(Vec3(1.0, 0.2, 0.1), 2.0));
  double sum = 0.0;
  for (size_t i = 0; i < 9; ++i) sum += std::pow(surface.derivatives(i)[2], 2);
  EXPECT_NEAR(surface.leverage(), sum, 1e-12);
  std::vector<BeamPoint> beside = pointsOnPlane(Vec3(1.0, 0.2, 0.1), 2.0);
  for (BeamPoint& point : beside) point.across_1 += 0.5;
  EXPECT_GT(BeamSurface(beside).leverage(), 1.0) << "a plane beside the beam is extrapolated";
}

TEST(BeamSurface, ScatterIsThatOfThePointsAndUnknownForTooFew) {
  constexpr double kScatter_per_m = 0.01;
  double mean = 0.0;
  for (int seed = 0; seed < 50; ++seed) {
    std::vector<BeamPoint> points = pointsOnPlane(Vec3(1.0, 0.3, 0.1), 2.0, 12);
    for (size_t i = 0; i < points.size(); ++i) {
      // Two-point noise of the variance kScatter_per_m^2.
      const bool is_up = ((seed * 7 + static_cast<int>(i) * 13 + seed * static_cast<int>(i)) / 3) % 2 == 0;
      points[i].inverse_distance_per_m += (is_up ? 1.0 : -1.0) * kScatter_per_m;
      points[i].weight = 1.0;
    }
    mean += std::pow(BeamSurface(points).scatter_per_m(), 2) / 50;
  }
  EXPECT_NEAR(std::sqrt(mean), kScatter_per_m, 0.3 * kScatter_per_m);
  EXPECT_EQ(BeamSurface(pointsOnPlane(Vec3(1.0, 0.3, 0.1), 2.0, 3)).scatter_per_m(),
            std::numeric_limits<double>::infinity());
}

TEST(BeamSurface, PointsOnALineGiveNoNumberThatIsNone) {
  std::vector<BeamPoint> points;
  for (int i = 0; i < 6; ++i) points.push_back({0.02 * i, 0.0, 0.5, 1.0});
  EXPECT_NEAR(BeamSurface(points).inverseDistance_per_m(), 0.5, 1e-6);
}

}  // namespace
}  // namespace lodeline

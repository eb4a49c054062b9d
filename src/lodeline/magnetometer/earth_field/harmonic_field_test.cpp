#include "lodeline/magnetometer/earth_field/harmonic_field.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lodeline {
namespace {

CoefficientTable oneTerm(int degree, int order, double g, double h) {
  CoefficientTable table = kWmm2025Coefficients;
  for (GaussCoefficient& term : table) {
    const bool is_wanted = term.degree == degree && term.order == order;
    term = {term.degree, term.order, is_wanted ? g : 0.0, is_wanted ? h : 0.0, 0.0, 0.0};
  }
  return table;
}

Vec3 fieldOf(const CoefficientTable& table, const Vec3& geocentric_m) {
  return harmonicField(table, &GaussCoefficient::g_nT, &GaussCoefficient::h_nT, geocentric_m);
}

// The field of a dipole m is (a/r)^3 (3 (m.u) u - m), with m = (g_11, h_11, g_10).
TEST(HarmonicField, OfDegreeOneIsThatOfADipole) {
  constexpr double kRadius_m = 6371200.0;
  const Vec3 u = Vec3(0.3, -0.5, 0.7).normalized();
  const Vec3 at_m = 1.2 * kRadius_m * u;
  const Vec3 sum = fieldOf(oneTerm(1, 0, 5.0, 0.0), at_m) + fieldOf(oneTerm(1, 1, -2.0, 3.0), at_m);
  const Vec3 dipole(-2.0, 3.0, 5.0);
  const Vec3 expected = std::pow(1.2, -3) * (3.0 * dipole.dot(u) * u - dipole);
  EXPECT_LT((sum - expected).norm(), 1e-12);
}

// A source-free field has neither divergence nor curl, whatever the term.
TEST(HarmonicField, HasNeitherDivergenceNorCurl) {
  const Vec3 at_m(3.1e6, -2.7e6, 4.9e6);
  constexpr double kStep_m = 1e2;
  for (const auto& [degree, order] : {std::pair(2, 0), {3, 1}, {7, 7}, {12, 5}, {12, 12}}) {
    const CoefficientTable table = oneTerm(degree, order, 2.0, -1.0);
    Mat3 jacobian;
    for (int i = 0; i < 3; ++i) {
      const Vec3 step = kStep_m * Vec3::Unit(i);
      jacobian.col(i) = (fieldOf(table, at_m + step) - fieldOf(table, at_m - step)) / (2.0 * kStep_m);
    }
    const double size = jacobian.norm();
    EXPECT_GT(size, 0.0);
    EXPECT_LT(std::abs(jacobian.trace()), 1e-5 * size) << degree << " " << order;
    EXPECT_LT((jacobian - jacobian.transpose()).norm(), 1e-5 * size) << degree << " " << order;
  }
}

TEST(HarmonicField, IsContinuousAtThePole) {
  const Vec3 pole_m(0.0, 0.0, 6.4e6);
  const Vec3 at_pole = fieldOf(kWmm2025Coefficients, pole_m);
  EXPECT_TRUE(at_pole.allFinite());
  EXPECT_LT((fieldOf(kWmm2025Coefficients, pole_m + Vec3(1.0, -1.0, 0.0)) - at_pole).norm(), 0.1);
}

// Semi-axes of the WGS84 ellipsoid.
TEST(GeocentricPosition, LiesOnTheEllipsoid) {
  EXPECT_LT((geocentricPosition({0.0, 90.0, 100.0}) - Vec3(0.0, 6378237.0, 0.0)).norm(), 1e-6);
  EXPECT_LT((geocentricPosition({-90.0, 20.0, 0.0}) - Vec3(0.0, 0.0, -6356752.314245)).norm(), 1e-6);
}

// Up is the direction in which the position moves with its height, north that in which it moves with
// latitude.
TEST(GeocentricPosition, HasAxesEastNorthUp) {
  const GeodeticPosition place{29.83, -82.60, 10.0};
  const auto moved = [&](double latitude_deg, double longitude_deg, double height_m) {
    const GeodeticPosition there{place.latitude_deg + latitude_deg, place.longitude_deg + longitude_deg,
                                 place.height_m + height_m};
    return (geocentricPosition(there) - geocentricPosition(place)).normalized();
  };
  Mat3 expected;
  expected << moved(0.0, 1e-4, 0.0), moved(1e-4, 0.0, 0.0), moved(0.0, 0.0, 10.0);
  EXPECT_LT((geocentricFromEnu(place) - expected).norm(), 1e-5);
}

}  // namespace
}  // namespace lodeline

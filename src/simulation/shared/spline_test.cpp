#include "simulation/shared/spline.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lodeline {
namespace {

double wiggle(double t) { return std::sin(1.3 * t) + 0.3 * std::cos(9.0 * t); }

TEST(Spline, ReproducesStraightLinesExactly) {
  const Spline spline(-1.0, 4.0, 0.25, [](double t) { return 3.0 - 2.0 * t; });
  for (const double t : {-1.0, 0.0, 0.6, 3.99, 4.0}) {
    EXPECT_NEAR(spline.at(t).value, 3.0 - 2.0 * t, 1e-13);
    EXPECT_NEAR(spline.at(t).rate, -2.0, 1e-12);
    EXPECT_NEAR(spline.at(t).acceleration, 0.0, 1e-11);
  }
}

TEST(Spline, DerivativesAgreeWithNumericOnes) {
  const Spline spline(0.0, 5.0, 0.2, wiggle);
  constexpr double kStep = 1e-5;
  for (double t = 0.1; t < 4.9; t += 0.0873) {
    const Jet before = spline.at(t - kStep);
    const Jet after = spline.at(t + kStep);
    EXPECT_NEAR(spline.at(t).rate, (after.value - before.value) / (2.0 * kStep), 1e-7);
    EXPECT_NEAR(spline.at(t).acceleration, (after.rate - before.rate) / (2.0 * kStep), 1e-6);
  }
}

TEST(Spline, IsContinuousUpToTheFourthDerivative) {
  constexpr double kSpacing = 0.5;
  const Spline spline(0.0, 10.0, kSpacing, wiggle);
  // The fourth derivative is linear between knots, so second differences of the acceleration give it exactly
  // where the stencil is within a span. The values extrapolated from both sides to the knot must be equal.
  constexpr double kStep = 0.02;
  const auto fourth = [&](double t) {
    return (spline.at(t + kStep).acceleration - 2.0 * spline.at(t).acceleration +
            spline.at(t - kStep).acceleration) /
           (kStep * kStep);
  };
  for (int k = 2; k < 18; ++k) {
    const double knot = k * kSpacing;
    const double from_left = 2.0 * fourth(knot - 0.05) - fourth(knot - 0.1);
    const double from_right = 2.0 * fourth(knot + 0.05) - fourth(knot + 0.1);
    EXPECT_NEAR(from_left, from_right, 1e-6);
  }
}

TEST(ModulatedSine, DerivativesAgreeWithNumericOnes) {
  const Spline amplitude(0.0, 5.0, 0.5, wiggle);
  const Spline phase(0.0, 5.0, 0.5, [](double t) { return 4.0 * t + 0.2 * t * t; });
  const auto at = [&](double t) { return modulatedSine(amplitude.at(t), phase.at(t)); };
  constexpr double kStep = 1e-5;
  for (double t = 0.1; t < 4.9; t += 0.31) {
    EXPECT_NEAR(at(t).rate, (at(t + kStep).value - at(t - kStep).value) / (2.0 * kStep), 1e-7);
    EXPECT_NEAR(at(t).acceleration, (at(t + kStep).rate - at(t - kStep).rate) / (2.0 * kStep), 1e-6);
  }
}

}  // namespace
}  // namespace lodeline

#include "lodeline/estimator/pressure/gauge_scale_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lodeline {
namespace {

/// Slope after a dive of `swing_m` up and down, read in units of 1/`factor` m with 3 cm of noise; both the
/// estimate's drift and the offset are large.
std::optional<double> slopeOf(double factor, double swing_m, double duration_s = 120.0) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  GaugeScaleCheck slope;
  double before_m = 0.0;
  for (double t = 0.0; t < duration_s; t += 0.5) {
    const double height_m = swing_m * std::sin(2.0 * M_PI * t / 60.0);
    const double reading = factor * (700.0 - height_m + 0.03 * normal(random));
    slope.add(Time::fromNanoseconds(static_cast<int64_t>(1e9 * t)), reading, height_m - before_m + 1e-3);
    before_m = height_m;
  }
  return slope.slope();
}

TEST(GaugeScaleCheck, IsOneForMetresAndTellsOtherUnits) {
  for (const double factor : {1.0, 0.974, -1.0, 100.0, 9806.65, 0.0980665, 3.2808})
    EXPECT_NEAR(slopeOf(factor, 2.0).value(), factor, 0.15 * std::abs(factor)) << factor;
  EXPECT_NEAR(slopeOf(0.0, 2.0).value(), 0.0, 1e-9);
}

TEST(GaugeScaleCheck, SaysNothingInALevelPassage) { EXPECT_FALSE(slopeOf(100.0, 0.03).has_value()); }

TEST(GaugeScaleCheck, IsNotMisledBySpikes) {
  GaugeScaleCheck slope;
  for (int i = 0; i < 100; ++i)
    slope.add(Time::fromNanoseconds(i * 500'000'000LL), i % 7 == 3 ? 655.35 : 0.1 * i, -0.1);
  EXPECT_NEAR(slope.slope().value(), 1.0, 1e-9);
}

TEST(GaugeScaleCheck, ForgetsWhatWasLongAgo) {
  GaugeScaleCheck slope;
  double time_s = 0.0;
  const auto sink = [&](double factor, int steps) {
    for (int i = 0; i < steps; ++i) {
      time_s += 3.0;
      slope.add(Time::fromNanoseconds(static_cast<int64_t>(1e9 * time_s)), factor * time_s * 0.1, -0.3);
    }
  };
  sink(0.0, 100);
  EXPECT_NEAR(slope.slope().value(), 0.0, 1e-9);
  sink(1.0, 20);
  EXPECT_NEAR(slope.slope().value(), 1.0, 1e-9);
}

TEST(GaugeScaleCheck, ExplainsItself) {
  EXPECT_NE(explainSlope(97.0).find("mbar"), std::string::npos);
  EXPECT_NE(explainSlope(-0.97).find("positive up"), std::string::npos);
  EXPECT_NE(explainSlope(0.02).find("blocked"), std::string::npos);
  EXPECT_NE(explainSlope(0.1).find("bar"), std::string::npos);
  EXPECT_NE(explainSlope(20.0).find("depth in m?"), std::string::npos);
}

}  // namespace
}  // namespace lodeline

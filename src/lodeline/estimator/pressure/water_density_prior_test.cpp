#include "lodeline/estimator/pressure/water_density_prior.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

namespace lodeline {
namespace {

TEST(WaterDensityPrior, AreBelievedWhereTheyFit) {
  for (const double water : {1.0, 0.975, 1.025}) {
    const ScalarPrior known = amongWaterDensities({water, 0.007});
    EXPECT_NEAR(known.value, water, 5e-4) << water;
    EXPECT_LT(known.sigma, 0.006) << water;
    const ScalarPrior off = amongWaterDensities({water + 0.003, 0.007});
    EXPECT_LT(std::abs(off.value - water), 0.0018) << water;
  }
}

TEST(WaterDensityPrior, LeaveAloneWhatIsNone) {
  const ScalarPrior brackish = amongWaterDensities({1.0125, 0.001});
  EXPECT_NEAR(brackish.value, 1.0125, 4e-4);
  EXPECT_NEAR(brackish.sigma, 0.001, 1e-4);
  EXPECT_NEAR(amongWaterDensities({0.94, 0.002}).value, 0.94, 1e-4) << "a gauge with a wrong scale";
}

TEST(WaterDensityPrior, SayNothingBetweenTwo) {
  const ScalarPrior seen{0.9875, 0.0085};
  const ScalarPrior known = amongWaterDensities(seen);
  EXPECT_GT(known.sigma, seen.sigma);
  EXPECT_FALSE(likelihoodBetween(seen, known));
}

TEST(WaterDensityPrior, SayNothingNewOfWhatIsKnownToManyDigits) {
  const ScalarPrior known = amongWaterDensities({0.975, 1e-7});
  EXPECT_NEAR(known.value, 0.975, 1e-9);
  EXPECT_NEAR(known.sigma, 1e-7, 1e-9);
}

TEST(WaterDensityPrior, LikelihoodTurnsWhatWasSeenIntoWhatIsKnownAndBack) {
  const ScalarPrior seen{0.979, 0.0075};
  const ScalarPrior known = amongWaterDensities(seen);
  const auto likelihood = likelihoodBetween(seen, known);
  ASSERT_TRUE(likelihood);
  EXPECT_LT(likelihood->value, seen.value);
  const double seen_information = std::pow(seen.sigma, -2), by_likelihood = std::pow(likelihood->sigma, -2);
  EXPECT_NEAR(std::pow(seen_information + by_likelihood, -0.5), known.sigma, 1e-12);
  EXPECT_NEAR((seen_information * seen.value + by_likelihood * likelihood->value) /
                  (seen_information + by_likelihood),
              known.value, 1e-12);
  const auto back = without(*likelihood, known);
  ASSERT_TRUE(back);
  EXPECT_NEAR(back->value, seen.value, 1e-12);
  EXPECT_NEAR(back->sigma, seen.sigma, 1e-12);
  EXPECT_FALSE(without(known, known)) << "nothing is left";
}

}  // namespace
}  // namespace lodeline

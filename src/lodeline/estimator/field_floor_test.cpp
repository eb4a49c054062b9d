#include "lodeline/estimator/field_floor.h"

#include <gtest/gtest.h>

#include <random>

namespace lodeline {
namespace {

// Learns for half an hour at 4 Hz from deviations whose floor has `floor_T`, lasts 5 s, and lies under white
// noise and an error of the prediction.
double learned(double floor_T, double white_sigma_T, double state_sigma_T, uint32_t seed) {
  MagnetometerOptions options;
  FieldFloor floor(options);
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  double along_T = 0.0, dip_T = 0.0;
  for (int i = 0; i < 4 * 1800; ++i) {
    if (i % 20 == 0) {
      along_T = std::hypot(floor_T, state_sigma_T) * normal(engine);
      dip_T = std::hypot(floor_T, state_sigma_T) * normal(engine);
    }
    floor.add(Time::fromSeconds(0.25 * i), along_T + white_sigma_T * normal(engine),
              dip_T + white_sigma_T * normal(engine), state_sigma_T * state_sigma_T,
              white_sigma_T * white_sigma_T);
  }
  return floor.sigma_T();
}

TEST(FieldFloor, StartsFromItsPrior) {
  const MagnetometerOptions options;
  FieldFloor floor(options);
  EXPECT_DOUBLE_EQ(floor.sigma_T(), options.floor_T);
  floor.add(Time::fromSeconds(0.0), 1e-6, 1e-6, 0.0, 0.0);
  EXPECT_DOUBLE_EQ(floor.sigma_T(), options.floor_T) << "one reading is no mean";
}

TEST(FieldFloor, FindsTheFloorUnderNoiseAndUncertainty) {
  for (const double floor_T : {0.05e-6, 0.2e-6, 1e-6}) {
    EXPECT_NEAR(learned(floor_T, 0.02e-6, 0.0, 1), floor_T, 0.2 * floor_T);
    EXPECT_NEAR(learned(floor_T, 0.3e-6, 0.1e-6, 2), floor_T, 0.35 * floor_T);
  }
  // A field that fits better than expected lowers it, as far as the prior lets it.
  EXPECT_LT(learned(0.0, 0.02e-6, 0.0, 3), 0.5 * MagnetometerOptions().floor_T);
}

TEST(FieldFloor, LearnsNothingWherePredictionIsTheDoubt) {
  const double floor_T = MagnetometerOptions().floor_T;
  EXPECT_NEAR(learned(floor_T, 0.02e-6, 20.0 * floor_T, 4), floor_T, 0.1 * floor_T);
}

TEST(FieldFloor, ForgetsWhatIsLongOver) {
  const MagnetometerOptions options;
  FieldFloor floor(options);
  const auto run = [&](double begin_s, double end_s, double deviation_T) {
    for (double t = begin_s; t < end_s; t += 1.0)
      floor.add(Time::fromSeconds(t), deviation_T, -deviation_T, 0.0, 0.0);
  };
  run(0.0, 200.0, 0.5e-6);
  const double disturbed_T = floor.sigma_T();
  EXPECT_GT(disturbed_T, 0.3e-6);
  run(200.0, 2000.0, 0.0);
  EXPECT_LT(floor.sigma_T(), 0.1 * disturbed_T);
}

}  // namespace
}  // namespace lodeline

#include "lodeline/estimator/magnetometer/field/student_t_weight.h"

#include <gtest/gtest.h>

#include <random>

namespace lodeline {
namespace {

constexpr double kFloor_T = 0.01e-6;

// Ten seconds of readings at 4 Hz that deviate by `deviation_T` in size.
StudentTWeight after(double deviation_T, double state_sigma_T, double white_sigma_T) {
  StudentTWeight deviation{MagnetometerOptions()};
  for (int i = 0; i < 40; ++i) {
    deviation.add(Time::fromSeconds(0.25 * i), Vec2(deviation_T, 0.0), state_sigma_T * state_sigma_T,
                  white_sigma_T * white_sigma_T);
  }
  return deviation;
}

TEST(StudentTWeight, IsTheFloorWhereNothingDeviates) {
  EXPECT_DOUBLE_EQ(StudentTWeight{MagnetometerOptions()}.sigma_T(kFloor_T), kFloor_T);
  EXPECT_DOUBLE_EQ(after(0.0, 0.0, 0.0).sigma_T(kFloor_T), kFloor_T);
  EXPECT_DOUBLE_EQ(after(kFloor_T, 0.0, 0.0).sigma_T(kFloor_T), kFloor_T) << "no more than usual";
}

TEST(StudentTWeight, GrowsWithTheDeviation) {
  const double freedom = MagnetometerOptions().student_dof;
  EXPECT_NEAR(after(0.2e-6, 0.0, 0.0).sigma_T(kFloor_T),
              std::sqrt((freedom * kFloor_T * kFloor_T + 0.2e-6 * 0.2e-6) / (freedom + 2.0)), 1e-12);
}

TEST(StudentTWeight, LeavesToStateAndNoiseWhatTheyAccountFor) {
  EXPECT_DOUBLE_EQ(after(0.2e-6, 0.15e-6, 0.0).sigma_T(kFloor_T), kFloor_T);
  // White noise is averaged, and the rest of it is part of the variance.
  StudentTWeight deviation{MagnetometerOptions()};
  std::mt19937 engine(1);
  std::normal_distribution<double> normal;
  double squares = 0.0;
  for (int i = 0; i < 4000; ++i) {
    deviation.add(Time::fromSeconds(0.1 * i), 0.05e-6 * Vec2(normal(engine), normal(engine)), 0.0,
                  0.05e-6 * 0.05e-6);
    squares += std::pow(deviation.sigma_T(kFloor_T), 2) / 4000;
  }
  EXPECT_LT(std::sqrt(squares), 1.3 * kFloor_T);
}

TEST(StudentTWeight, ForgetsAfterASecondOrTwo) {
  StudentTWeight deviation = after(0.2e-6, 0.0, 0.0);
  const double disturbed_T = deviation.sigma_T(kFloor_T);
  for (int i = 0; i < 12; ++i) deviation.add(Time::fromSeconds(10.0 + 0.25 * i), Vec2::Zero(), 0.0, 0.0);
  EXPECT_LT(deviation.sigma_T(kFloor_T), 0.2 * disturbed_T);
}

TEST(StudentTWeight, SeesTheFirstReadingAfterAGapAsItIs) {
  StudentTWeight deviation = after(0.0, 0.0, 0.0);
  deviation.add(Time::fromSeconds(100.0), Vec2(0.0, 0.2e-6), 0.0, 0.0);
  EXPECT_GT(deviation.sigma_T(kFloor_T), 0.08e-6);
}

}  // namespace
}  // namespace lodeline

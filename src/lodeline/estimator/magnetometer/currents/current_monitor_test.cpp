#include "lodeline/estimator/magnetometer/currents/current_monitor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lodeline {
namespace {

constexpr double kSigma_T_per_A = 0.01e-6;

struct DiveOptions {
  double duration_s = 120.0;
  double largest_A = 20.0;
  Vec3 wrong_T_per_A = Vec3::Zero();  ///< of the first channel: true minus calibrated field
  double noise_T = 0.1e-6;
  double wander_T = 0.0;  ///< size of a field that goes up and down within 15 s, from iron that is passed
  unsigned seed = 1;
};

/// A dive with two channels whose currents change every three seconds.
CurrentMonitor after(const DiveOptions& options) {
  std::mt19937 random(options.seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  CurrentMonitor monitor(2, kSigma_T_per_A);
  Eigen::VectorXd currents_A = Eigen::VectorXd::Zero(2);
  for (int i = 0; i < static_cast<int>(5.0 * options.duration_s); ++i) {
    const double time_s = i / 5.0;
    if (i % 15 == 0) currents_A = options.largest_A * Eigen::Vector2d(uniform(random), uniform(random));
    const Vec3 wander_B = options.wander_T * std::sin(2.0 * 3.14159 * time_s / 15.0) * Vec3(0.6, 0.8, 0.0);
    const Vec3 noise_B = options.noise_T * Vec3(normal(random), normal(random), normal(random));
    monitor.add(Time::fromNanoseconds(0) + Duration::fromSeconds(1000.0 + time_s), currents_A,
                currents_A[0] * options.wrong_T_per_A + wander_B + noise_B,
                options.noise_T * options.noise_T);
  }
  return monitor;
}

TEST(CurrentMonitor, BelievesARightCalibration) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    DiveOptions options;
    options.seed = seed;
    options.wrong_T_per_A = Vec3(1.0, -1.0, 0.5) * kSigma_T_per_A;
    EXPECT_FALSE(after(options).isContradicted()) << seed;
    DiveOptions noisy = options;
    noisy.noise_T = 0.5e-6;
    EXPECT_FALSE(after(noisy).isContradicted()) << seed << ", a consumer sensor";
    options.wander_T = 3e-6;
    EXPECT_FALSE(after(options).isContradicted()) << seed << ", iron";
  }
}

TEST(CurrentMonitor, NoticesAWrongOneWithinHalfAMinute) {
  DiveOptions options;
  options.duration_s = 30.0;
  options.wrong_T_per_A = Vec3(0.15e-6, 0.0, -0.1e-6);
  const CurrentMonitor monitor = after(options);
  EXPECT_TRUE(monitor.isContradicted());
  EXPECT_NEAR(monitor.differences_T_per_A()(0, 0), 0.15e-6, 0.03e-6);
  EXPECT_NEAR(monitor.differences_T_per_A()(1, 0), 0.0, 0.03e-6);
}

TEST(CurrentMonitor, NoticesItAmongIron) {
  DiveOptions options;
  options.wander_T = 2e-6;
  options.duration_s = 300.0;
  options.wrong_T_per_A = Vec3(0.3e-6, 0.0, -0.2e-6);
  EXPECT_TRUE(after(options).isContradicted());
}

TEST(CurrentMonitor, SaysNothingWithoutCurrents) {
  DiveOptions options;
  options.largest_A = 0.0;
  options.wander_T = 5e-6;
  const CurrentMonitor monitor = after(options);
  EXPECT_FALSE(monitor.isContradicted());
  EXPECT_EQ(monitor.leftField_T(), 0.0);
}

}  // namespace
}  // namespace lodeline

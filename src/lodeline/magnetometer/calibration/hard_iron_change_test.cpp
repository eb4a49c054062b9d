#include "lodeline/magnetometer/calibration/hard_iron_change.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "lodeline/magnetometer/calibration/calibrate_magnetometer.h"

namespace lodeline {
namespace {

constexpr double kSteadyField_T = 45e-6;
constexpr double kReadingNoise_T = 0.07e-6;

// 90 s at 50 Hz of a rig that rotates through all directions about every ten seconds.
std::vector<CorrectedReading> turned(const std::function<Vec3(double)>& iron_T) {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal(0.0, kReadingNoise_T);
  std::vector<CorrectedReading> readings;
  for (int i = 0; i < 4500; ++i) {
    const double t_s = i / 50.0;
    const Vec3 direction = Vec3(std::sin(1.1 * t_s) * std::cos(0.7 * t_s),
                                std::sin(1.1 * t_s) * std::sin(0.7 * t_s), std::cos(1.1 * t_s));
    readings.push_back({Time::fromSeconds(t_s), kSteadyField_T * direction + iron_T(t_s) +
                                                    Vec3(normal(engine), normal(engine), normal(engine))});
  }
  return readings;
}

TEST(HardIronChange, IsNothingWhereTheIronStays) {
  const HardIronChange change =
      findHardIronChange(turned([](double) { return Vec3::Zero(); }), kSteadyField_T);
  EXPECT_FALSE(change.step);
  EXPECT_LT(change.spread_T, 0.01e-6);
}

TEST(HardIronChange, FindsACurrentThatIsSwitched) {
  const Vec3 current_T(0.2e-6, -0.25e-6, 0.1e-6);
  const auto iron_T = [&](double t_s) { return Vec3((t_s < 52.0 ? -0.5 : 0.5) * current_T); };
  const HardIronChange change = findHardIronChange(turned(iron_T), kSteadyField_T);
  ASSERT_TRUE(change.step);
  EXPECT_NEAR(change.step->time.seconds(), 52.0, 2.0);
  EXPECT_NEAR(change.step->size_T, current_T.norm(), 0.05e-6);
  EXPECT_GT(change.spread_T, 0.07e-6);
}

TEST(HardIronChange, TakesASlowCreepForSpread) {
  const auto iron_T = [](double t_s) { return Vec3(0.0, 0.3e-6 * (t_s / 90.0 - 0.5), 0.0); };
  const HardIronChange change = findHardIronChange(turned(iron_T), kSteadyField_T);
  EXPECT_FALSE(change.step);
  EXPECT_NEAR(change.spread_T, 0.3e-6 / std::sqrt(12.0) / std::sqrt(3.0), 0.02e-6);
}

// A hard iron change of 12 sigma of the calibration.
TEST(HardIronChange, WidensWhatACalibrationClaims) {
  const Vec3 current_T(0.3e-6, 0.0, 0.2e-6);
  MagnetometerRecord record;
  for (const CorrectedReading& reading :
       turned([&](double t_s) { return t_s < 45.0 ? Vec3::Zero() : current_T; }))
    record.magnetometer.push_back({reading.time, reading.field_M});
  Diagnostics diagnostics;
  const auto result = calibrateMagnetometer(record, {}, &diagnostics);
  EXPECT_EQ(diagnostics.count("magnetometer_current"), 1);
  ASSERT_TRUE(result.hard_iron_step_T);
  EXPECT_NEAR(*result.hard_iron_step_T, current_T.norm(), 0.05e-6);
  const Vec3 sigma_T = result.fit.sigmas().segment<3>(fit_parameter::kHardIron);
  for (const Vec3& truth_T : {Vec3(Vec3::Zero()), current_T}) {
    const Vec3 error_T = result.fit.hard_iron - truth_T;
    EXPECT_LT(error_T.cwiseQuotient(sigma_T).cwiseAbs().maxCoeff(), 3.0);
  }
}

}  // namespace
}  // namespace lodeline

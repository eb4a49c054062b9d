#include "simulation/sensors/imu_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

constexpr double kRate = 200.0;

std::vector<Vec3> gyroscopeAtRest(const TriadErrors& gyroscope, uint64_t seed, int count,
                                  double rate_hz = kRate) {
  ImuErrors errors;
  errors.gyroscope = gyroscope;
  ImuModel model(errors, rate_hz, seed);
  std::vector<Vec3> readings;
  for (int i = 0; i < count; ++i) {
    ImuSample perfect;
    perfect.time = Time::fromSeconds(i / rate_hz);
    readings.push_back(model.measure(perfect).angular_velocity_B);
  }
  return readings;
}

// Non-overlapping Allan deviation over all three axes at a cluster of `size` samples.
double allanDeviation(const std::vector<Vec3>& readings, int size) {
  std::vector<Vec3> means;
  for (size_t i = 0; i + size <= readings.size(); i += size) {
    Vec3 sum = Vec3::Zero();
    for (int j = 0; j < size; ++j) sum += readings[i + j];
    means.push_back(sum / size);
  }
  double squares = 0.0;
  for (size_t i = 1; i < means.size(); ++i) squares += (means[i] - means[i - 1]).squaredNorm();
  return std::sqrt(squares / (6.0 * static_cast<double>(means.size() - 1)));
}

TEST(ImuModel, WithoutErrorsReadsTheTruth) {
  ImuModel model({}, kRate, 1);
  const ImuSample truth{Time::fromSeconds(1.0), Vec3(0.1, -0.2, 0.3), Vec3(1.0, 2.0, 9.0)};
  const ImuSample reading = model.measure(truth);
  EXPECT_EQ(reading.angular_velocity_B, truth.angular_velocity_B);
  EXPECT_EQ(reading.specific_force_B, truth.specific_force_B);
}

TEST(ImuModel, WhiteNoiseHasItsDensity) {
  TriadErrors errors;
  errors.noise_density = 1e-3;
  const auto readings = gyroscopeAtRest(errors, 3, 100000);
  // Allan deviation of white noise: density / sqrt(tau).
  EXPECT_NEAR(allanDeviation(readings, 1), 1e-3 * std::sqrt(kRate), 1e-3 * std::sqrt(kRate) * 0.02);
  EXPECT_NEAR(allanDeviation(readings, 100), 1e-3 / std::sqrt(0.5), 1e-3 / std::sqrt(0.5) * 0.06);
}

TEST(ImuModel, RandomWalkGrowsWithTheSquareRootOfTime) {
  TriadErrors errors;
  errors.random_walk = 1e-4;
  double squares = 0.0;
  for (uint64_t seed = 0; seed < 100; ++seed) {
    squares += gyroscopeAtRest(errors, seed, 1001, 10.0).back().squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(squares / 300.0), 1e-4 * std::sqrt(100.0), 1e-3 * 0.13);
}

TEST(ImuModel, BiasInstabilityIsTheFloorOfTheAllanDeviation) {
  TriadErrors errors;
  errors.bias_instability = 1e-3;
  // Three decades inside the modelled range of time constants, within the 10 % error of the sum of processes
  // and the sample.
  const auto readings = gyroscopeAtRest(errors, 5, 400000, 5.0);
  for (const int size : {50, 200, 1000})
    EXPECT_NEAR(allanDeviation(readings, size), 0.664e-3, 0.664e-4) << size;
}

TEST(ImuModel, AppliesBiasMatrixWarmUpAndRange) {
  ImuErrors errors;
  errors.accelerometer.turn_on_bias = Vec3(0.1, 0.0, 0.0);
  errors.accelerometer.matrix.diagonal() = Vec3(1.01, 1.0, 1.0);
  errors.accelerometer.warm_up = Vec3(0.0, 0.5, 0.0);
  errors.accelerometer.warm_up_time_s = 100.0;
  errors.accelerometer.range = 9.0;
  ImuModel model(errors, kRate, 1);
  ImuSample truth;
  truth.specific_force_B = Vec3(5.0, 0.0, 9.8);
  EXPECT_LT((model.measure(truth).specific_force_B - Vec3(5.15, 0.5, 9.0)).norm(), 1e-12);
  truth.time = Time::fromSeconds(100.0);
  EXPECT_LT((model.measure(truth).specific_force_B - Vec3(5.15, 0.5 * std::exp(-1.0), 9.0)).norm(), 1e-12);
  EXPECT_LT((model.accelerometerBias() - Vec3(0.1, 0.5 * std::exp(-1.0), 0.0)).norm(), 1e-12);
}

TEST(ImuGrades, FlickerOfEverySensorIsFlatAtItsInstability) {
  for (const std::string_view name : imuGradeNames()) {
    ImuErrors errors;
    errors.accelerometer.bias_instability = imuGrade(name).accelerometer.bias_instability;
    errors.gyroscope.bias_instability = imuGrade(name).gyroscope.bias_instability;
    ImuModel model(errors, 2.0, 11);
    std::vector<Vec3> rates, forces;
    for (int i = 0; i < 100000; ++i) {
      ImuSample perfect;
      perfect.time = Time::fromSeconds(0.5 * i);
      const ImuSample reading = model.measure(perfect);
      rates.push_back(reading.angular_velocity_B);
      forces.push_back(reading.specific_force_B);
    }
    for (const int size : {20, 100, 500}) {
      EXPECT_NEAR(allanDeviation(rates, size) / errors.gyroscope.bias_instability, 0.664, 0.1) << size;
      EXPECT_NEAR(allanDeviation(forces, size) / errors.accelerometer.bias_instability, 0.664, 0.1) << size;
    }
  }
}

TEST(ImuModel, TheGyroscopeReadsARateThatFollowsTheSpecificForce) {
  ImuErrors errors;
  errors.g_sensitivity(0, 2) = 0.1 * std::numbers::pi / 180.0 / 9.80665;  // 0.1 deg/s/g
  ImuModel model(errors, kRate, 1);
  ImuSample truth;
  truth.specific_force_B = Vec3(0.0, 0.0, 9.80665);
  const double rate_deg_per_s = model.measure(truth).angular_velocity_B.x() * 180.0 / std::numbers::pi;
  EXPECT_NEAR(rate_deg_per_s, 0.1, 1e-12);
  EXPECT_EQ(model.gyroscopeBias(), Vec3::Zero());  // no part of the bias: it turns with the rig
}

TEST(ImuGrades, GSensitivityHasTheSizeOfTheGrade) {
  const auto rms_deg_per_s_per_g = [](std::string_view grade) {
    double squares = 0.0;
    for (uint64_t seed = 0; seed < 200; ++seed)
      squares += drawImuErrors(imuGrade(grade), {.g_sensitivity = true}, seed).g_sensitivity.squaredNorm();
    return std::sqrt(squares / 1800.0) * 9.80665 * 180.0 / std::numbers::pi;
  };
  EXPECT_NEAR(rms_deg_per_s_per_g("consumer"), 0.1, 0.01);
  EXPECT_NEAR(rms_deg_per_s_per_g("gx5-25"), 0.03, 0.003);
  EXPECT_NEAR(rms_deg_per_s_per_g("gv7"), 0.01, 0.001);
  EXPECT_TRUE(drawImuErrors(imuGrade("gv7"), {}, 1).g_sensitivity.isZero());
}

TEST(ImuGrades, AreOrderedAndRefuseUnknownNames) {
  EXPECT_LT(imuGrade("gv7").gyroscope.bias_instability, imuGrade("gx5-25").gyroscope.bias_instability);
  EXPECT_LT(imuGrade("gx5-25").gyroscope.noise_density, imuGrade("consumer").gyroscope.noise_density);
  EXPECT_THROW(imuGrade("gx4"), UsageError);
}

TEST(ImuGrades, SwitchingOneErrorLeavesTheOthersAsDrawn) {
  SpecimenOptions all{true, true, true, true};
  SpecimenOptions no_bias = all;
  no_bias.turn_on_bias = false;
  const ImuErrors a = drawImuErrors(imuGrade("gx5-25"), all, 9);
  const ImuErrors b = drawImuErrors(imuGrade("gx5-25"), no_bias, 9);
  EXPECT_EQ(b.gyroscope.turn_on_bias, Vec3::Zero());
  EXPECT_NE(a.gyroscope.turn_on_bias, Vec3::Zero());
  EXPECT_EQ(a.accelerometer.matrix, b.accelerometer.matrix);
  EXPECT_EQ(a.gyroscope.warm_up, b.gyroscope.warm_up);
}

}  // namespace
}  // namespace lodeline

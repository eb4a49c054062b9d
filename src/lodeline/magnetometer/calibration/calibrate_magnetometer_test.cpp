#include "lodeline/magnetometer/calibration/calibrate_magnetometer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "lodeline/diagnostics.h"
#include "lodeline/magnetometer/calibration/calibration_report.h"
#include "lodeline/magnetometer/calibration/heading/test_turning_sensor.h"
#include "lodeline/magnetometer/iron/test_cloud.h"

// The complete calibration with imperfect sensors.

namespace lodeline {
namespace {

using ::testing::HasSubstr;

constexpr double kField_T = 45e-6;

/// A sensor with TestMotion and additional rolling, because TestMotion covers too little of the sphere.
test::TurningSensor rollingSensor() {
  test::TurningSensor sensor;
  sensor.duration_s = 40.0;
  sensor.motion.a = Vec3(2.2, -0.9, 1.3);
  sensor.motion.b = Vec3(-1.1, 1.9, 0.8);
  sensor.imu_rate_hz = 400.0;
  return sensor;
}

MagnetometerRecord recordOf(const test::TurningSensor& sensor, bool with_imu = true) {
  MagnetometerRecord record;
  for (const NormalizedFieldSample& sample : sensor.field()) {
    record.magnetometer.push_back({sample.time, kField_T * sample.field_M});
  }
  if (with_imu) record.imu = sensor.imu();
  record.imu_noise.gyroscope_density_rad_per_s_sqrtHz = sensor.gyroscope_density;
  return record;
}

/// Largest error of a corrected reading relative to the truth over all directions, in units of the field.
double worstError(const MagnetometerFit& fit, const test::TurningSensor& sensor) {
  double worst = 0.0;
  test::CloudTruth every;
  every.correction.setIdentity();
  every.hard_iron.setZero();
  for (const Vec3& direction : test::cloud(every, 100)) {
    const Vec3 reading = kField_T * (sensor.truth.hard_iron + sensor.truth.soft_iron * direction);
    const Vec3 corrected = fit.corrected_M(reading) / fit.field_strength_T;
    worst = std::max(worst, (corrected - direction).norm());
  }
  return worst;
}

TEST(CalibrateMagnetometer, FindsEverythingAboutAHealthySensor) {
  const test::TurningSensor sensor = rollingSensor();
  Diagnostics diagnostics;
  const auto result = calibrateMagnetometer(recordOf(sensor), {}, &diagnostics);
  EXPECT_EQ(result.fit.model, IronModel::Full);
  ASSERT_TRUE(result.inertial) << result.without_inertial;
  EXPECT_LT(worstError(result.fit, sensor), 3e-3);
  EXPECT_LT(result.fit.body_from_magnetometer->angularDistance(sensor.truth.body_from_magnetometer), 2e-3);
  EXPECT_NEAR(*result.fit.time_offset_to_imu_s, sensor.truth.time_offset_s, 1e-3);
  EXPECT_NEAR(*result.fit.dip_rad, sensor.truth.dip_rad, 0.02);
  EXPECT_NEAR(*result.fit.noise_density_T_per_sqrtHz, kField_T * sensor.field_sigma / std::sqrt(50.0), 2e-10);
  EXPECT_THAT(result.fit.verdict, HasSubstr("Good"));
  EXPECT_EQ(diagnostics.ranked().size(), 0u);
  EXPECT_THAT(calibrationText(result), HasSubstr("rotation to IMU"));
  EXPECT_EQ(calibrationJson(result)["model"], "full");
}

TEST(CalibrateMagnetometer, WithoutImuTheRotationStaysUnknown) {
  const test::TurningSensor sensor = rollingSensor();
  Diagnostics diagnostics;
  const auto result = calibrateMagnetometer(recordOf(sensor, false), {}, &diagnostics);
  EXPECT_FALSE(result.inertial);
  EXPECT_FALSE(result.fit.body_from_magnetometer);
  EXPECT_LT(worstError(result.fit, sensor), 5e-3);
  EXPECT_THAT(result.fit.verdict, HasSubstr("rotation to the IMU is not"));
  EXPECT_NEAR(*result.fit.noise_density_T_per_sqrtHz, kField_T * sensor.field_sigma / std::sqrt(50.0), 1e-9);
}

// No motion determines the rotation of the gyroscope's axes, to which the estimated rotation refers, relative
// to the body.
TEST(CalibrateMagnetometer, DoubtsTheRotationAsItDoubtsTheAxesOfTheImu) {
  const test::TurningSensor sensor = rollingSensor();
  const auto headingSigma_rad = [&](double gyroscope_density) {
    MagnetometerRecord record = recordOf(sensor);
    record.imu_noise.gyroscope_density_rad_per_s_sqrtHz = gyroscope_density;
    Diagnostics diagnostics;
    return calibrateMagnetometer(record, {}, &diagnostics).fit.heading_error_rad;
  };
  const double limit = imu_axes::kCalibratedBelow_rad_per_s_sqrtHz;
  const double calibrated = headingSigma_rad(0.99 * limit), doubted = headingSigma_rad(1.01 * limit);
  EXPECT_GT(calibrated, imu_axes::kCalibratedSigma / std::sqrt(2.0));
  EXPECT_LT(calibrated, 5.0 * imu_axes::kCalibratedSigma);
  EXPECT_GT(doubted, imu_axes::kUncalibratedSigma / std::sqrt(2.0));
  EXPECT_LT(doubted, 5.0 * imu_axes::kUncalibratedSigma);
}

TEST(CalibrateMagnetometer, WorksAtOneHertzAndAtOneKilohertz) {
  for (const double rate_hz : {1.0, 1000.0}) {
    test::TurningSensor sensor = rollingSensor();
    sensor.field_rate_hz = rate_hz;
    sensor.imu_rate_hz = 200.0;
    sensor.duration_s = rate_hz < 10.0 ? 240.0 : 20.0;
    Diagnostics diagnostics;
    const auto result = calibrateMagnetometer(recordOf(sensor), {}, &diagnostics);
    EXPECT_EQ(result.fit.model, IronModel::Full) << rate_hz;
    ASSERT_TRUE(result.inertial) << rate_hz << " " << result.without_inertial;
    EXPECT_LT(worstError(result.fit, sensor), 6e-3) << rate_hz;
    EXPECT_LT(result.fit.body_from_magnetometer->angularDistance(sensor.truth.body_from_magnetometer), 4e-3)
        << rate_hz;
  }
}

TEST(CalibrateMagnetometer, StandsRepetitionsNansAndAStretchOfFrozenReadings) {
  const test::TurningSensor sensor = rollingSensor();
  MagnetometerRecord record = recordOf(sensor);
  for (size_t i = 3; i < record.magnetometer.size(); i += 3) {
    record.magnetometer[i].field_M = record.magnetometer[i - 1].field_M;
  }
  for (size_t i = 500; i < 700; ++i) record.magnetometer[i].field_M = record.magnetometer[499].field_M;
  record.magnetometer[50].field_M.x() = std::nan("");
  Diagnostics diagnostics;
  const auto result = calibrateMagnetometer(record, {}, &diagnostics);
  EXPECT_EQ(result.fit.model, IronModel::Full);
  EXPECT_LT(worstError(result.fit, sensor), 5e-3);
  EXPECT_EQ(diagnostics.count("magnetometer_frozen"), 1);
  EXPECT_EQ(diagnostics.count("magnetometer_not_finite"), 1);
}

TEST(CalibrateMagnetometer, LeavesOutSaturatedReadings) {
  const test::TurningSensor sensor = rollingSensor();
  MagnetometerRecord record = recordOf(sensor);
  for (MagnetometerSample& sample : record.magnetometer) {
    sample.field_M = sample.field_M.cwiseMin(1.05 * kField_T);
  }
  Diagnostics diagnostics;
  const auto result = calibrateMagnetometer(record, {}, &diagnostics);
  EXPECT_EQ(diagnostics.count("magnetometer_saturated"), 1);
  EXPECT_LT(worstError(result.fit, sensor), 0.01);
}

TEST(CalibrateMagnetometer, RefusesAFrozenOrStillSensor) {
  MagnetometerRecord record = recordOf(rollingSensor());
  for (MagnetometerSample& sample : record.magnetometer) sample.field_M = Vec3(1e-5, 2e-5, 3e-5);
  Diagnostics diagnostics;
  EXPECT_THROW(calibrateMagnetometer(record, {}, &diagnostics), EstimationError);
  test::TurningSensor still = rollingSensor();
  still.motion.a.setZero();
  still.motion.b.setZero();
  EXPECT_THROW(calibrateMagnetometer(recordOf(still), {}, &diagnostics), EstimationError);
}

// Counts that alternate about one value are on a small sphere, for any field at the site.
TEST(CalibrateMagnetometer, RefusesTheFlickerOfASensorAtRest) {
  MagnetometerRecord record = recordOf(rollingSensor(), false);
  std::mt19937 random(1);
  for (MagnetometerSample& sample : record.magnetometer) {
    sample.field_M = Vec3(12e-6, -20e-6, 40e-6);
    for (int axis = 0; axis < 3; ++axis)
      sample.field_M[axis] += 0.15e-6 * (static_cast<int>(random() % 3) - 1);
  }
  CalibrationOptions with_site;
  with_site.site_field_ENU = Vec3(0.0, 24e-6, -38e-6);
  for (const CalibrationOptions& options : {CalibrationOptions(), with_site}) {
    Diagnostics diagnostics;
    EXPECT_THROW(calibrateMagnetometer(record, options, &diagnostics), EstimationError);
  }
}

TEST(CalibrateMagnetometer, LeavesOutWildReadings) {
  const test::TurningSensor sensor = rollingSensor();
  const MagnetometerRecord healthy = recordOf(sensor, false);
  Diagnostics diagnostics;
  const MagnetometerFit expected = calibrateMagnetometer(healthy, {}, &diagnostics).fit;
  for (const Vec3& wild_uT :
       {Vec3(1000.0, 0.0, 0.0), Vec3(600.0, -600.0, 600.0), Vec3(2668.0, 2407.0, 2217.0),
        Vec3(-4912.0, -4912.0, -4912.0), Vec3(1500.0, 0.0, 0.0)}) {
    for (const size_t every : {healthy.magnetometer.size(), size_t{401}}) {
      MagnetometerRecord record = healthy;
      int spoilt = 0;
      for (size_t i = every / 2; i < record.magnetometer.size(); i += every, ++spoilt)
        record.magnetometer[i].field_M = 1e-6 * wild_uT + 1e-9 * Vec3::Constant(static_cast<double>(i));
      const auto result = calibrateMagnetometer(record, {}, &diagnostics);
      EXPECT_LT((result.fit.hard_iron - expected.hard_iron).cwiseAbs().maxCoeff(), 0.05e-6)
          << wild_uT.transpose();
      EXPECT_GE(std::count(result.iron.used.begin(), result.iron.used.end(), false), spoilt);
      EXPECT_THAT(calibrationText(result), HasSubstr("readings did not fit"));
    }
  }
}

TEST(CalibrateMagnetometer, WarnsWhereTheSiteDisagrees) {
  const test::TurningSensor sensor = rollingSensor();
  CalibrationOptions options;
  options.site_field_ENU = Vec3(0.0, 40e-6, -20e-6);
  Diagnostics diagnostics;
  const auto result = calibrateMagnetometer(recordOf(sensor), options, &diagnostics);
  EXPECT_EQ(diagnostics.count("magnetometer_dip"), 1);
  EXPECT_NEAR(result.fit.field_strength_T, options.site_field_ENU->norm(), 1e-12);
  EXPECT_TRUE(result.fit.field_strength_known);
}

TEST(CalibrateMagnetometer, KeepsTheOldCalibrationWhereTheReadingsSayNothing) {
  test::TurningSensor still = rollingSensor();
  still.motion.a *= 0.05;
  still.motion.b *= 0.05;
  CalibrationOptions options;
  options.old.emplace();
  options.old->hard_iron = Vec3(1e-6, 0.0, 0.0);
  options.old->field_strength_T = kField_T;
  Diagnostics diagnostics;
  const auto result = calibrateMagnetometer(recordOf(still), options, &diagnostics);
  EXPECT_EQ(result.fit.model, IronModel::Kept);
  EXPECT_EQ(result.fit.hard_iron, options.old->hard_iron);
  EXPECT_THAT(result.fit.verdict, HasSubstr("kept"));
  options.old->raw_readings = true;
  EXPECT_THROW(calibrateMagnetometer(recordOf(still), options, &diagnostics), InputError);
}

TEST(ComparisonText, SaysWhetherADifferenceMatters) {
  const test::TurningSensor sensor = rollingSensor();
  Diagnostics diagnostics;
  const MagnetometerFit before = calibrateMagnetometer(recordOf(sensor), {}, &diagnostics).fit;
  test::TurningSensor later = sensor;
  later.seed = 77;
  const MagnetometerFit again = calibrateMagnetometer(recordOf(later), {}, &diagnostics).fit;
  EXPECT_THAT(comparisonText(before, again, 1.0), HasSubstr("not significant"));
  later.truth.hard_iron += Vec3(0.01, 0.0, 0.0);
  const MagnetometerFit moved = calibrateMagnetometer(recordOf(later), {}, &diagnostics).fit;
  EXPECT_THAT(comparisonText(before, moved, 1.0), HasSubstr("is significant"));
}

}  // namespace
}  // namespace lodeline

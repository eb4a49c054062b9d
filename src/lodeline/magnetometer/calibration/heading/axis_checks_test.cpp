#include "lodeline/magnetometer/calibration/heading/axis_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/magnetometer/calibration/calibrate_magnetometer.h"
#include "lodeline/magnetometer/calibration/heading/test_turning_sensor.h"

// Axes that are exchanged or have the wrong sign.

namespace lodeline {
namespace {

using ::testing::HasSubstr;

constexpr double kTurnedField_T = 45e-6;

MagnetometerRecord turnedRecord() {
  test::TurningSensor sensor;
  sensor.duration_s = 40.0;
  sensor.motion.a = Vec3(2.2, -0.9, 1.3);
  sensor.motion.b = Vec3(-1.1, 1.9, 0.8);
  sensor.imu_rate_hz = 400.0;
  MagnetometerRecord record;
  for (const NormalizedFieldSample& sample : sensor.field())
    record.magnetometer.push_back({sample.time, kTurnedField_T * sample.field_M});
  record.imu = sensor.imu();
  record.imu_noise.gyroscope_density_rad_per_s_sqrtHz = sensor.gyroscope_density;
  record.body_from_magnetometer = sensor.truth.body_from_magnetometer;
  return record;
}

void exchange(MagnetometerRecord* record) {
  for (MagnetometerSample& sample : record->magnetometer) std::swap(sample.field_M.x(), sample.field_M.y());
}

const Vec3 kSite_ENU = kTurnedField_T * Vec3(0.0, std::cos(1.0), -std::sin(1.0));

TEST(AxisChecks, SayNothingOfAHealthySensor) {
  for (const bool with_site : {false, true}) {
    CalibrationOptions options;
    if (with_site) options.site_field_ENU = kSite_ENU;
    Diagnostics diagnostics;
    const auto result = calibrateMagnetometer(turnedRecord(), options, &diagnostics);
    EXPECT_TRUE(diagnostics.ranked().empty()) << diagnostics.ranked().front().first_message;
    EXPECT_THAT(result.fit.verdict, HasSubstr("Good"));
  }
}

TEST(AxisChecks, NameMirroredAxesByDipAndRotation) {
  MagnetometerRecord record = turnedRecord();
  exchange(&record);
  Diagnostics diagnostics;
  const auto result = calibrateMagnetometer(record, {}, &diagnostics);
  EXPECT_LT(*result.fit.dip_rad, -0.9);
  EXPECT_EQ(diagnostics.count("magnetometer_reversed"), 1);
  EXPECT_EQ(diagnostics.count("magnetometer_rotation"), 1);
}

TEST(AxisChecks, RefuseMirroredOrReversedAxesWhereTheSiteTells) {
  CalibrationOptions options;
  options.site_field_ENU = kSite_ENU;
  MagnetometerRecord exchanged = turnedRecord();
  exchange(&exchanged);
  MagnetometerRecord reversed = turnedRecord();
  for (MagnetometerSample& sample : reversed.magnetometer) sample.field_M *= -1.0;
  for (const MagnetometerRecord& record : {exchanged, reversed}) {
    Diagnostics diagnostics;
    try {
      calibrateMagnetometer(record, options, &diagnostics);
      ADD_FAILURE() << "not refused";
    } catch (const EstimationError& error) {
      EXPECT_THAT(error.what(), HasSubstr("left-handed or of reversed sign"));
    }
  }
}

TEST(AxisChecks, NameAReversedSignByTheDipAlone) {
  MagnetometerRecord record = turnedRecord();
  for (MagnetometerSample& sample : record.magnetometer) sample.field_M *= -1.0;
  Diagnostics diagnostics;
  const auto result = calibrateMagnetometer(record, {}, &diagnostics);
  ASSERT_TRUE(result.fit.dip_rad);
  EXPECT_LT(*result.fit.dip_rad, -0.9);
  EXPECT_EQ(diagnostics.count("magnetometer_reversed"), 1);
}

TEST(AxisChecks, NameTheGyroscopeWhoseSignsAreWrong) {
  const std::vector<Vec3> all_signs = {Vec3(-1, -1, -1), Vec3(-1, 1, 1),  Vec3(1, -1, 1), Vec3(1, 1, -1),
                                       Vec3(-1, -1, 1),  Vec3(-1, 1, -1), Vec3(1, -1, -1)};
  for (const Vec3& signs : all_signs) {
    MagnetometerRecord record = turnedRecord();
    for (ImuSample& sample : record.imu)
      sample.angular_velocity_B = sample.angular_velocity_B.cwiseProduct(signs);
    Diagnostics diagnostics;
    const auto result = calibrateMagnetometer(record, {}, &diagnostics);
    EXPECT_EQ(diagnostics.count("gyroscope_axes"), 1) << signs.transpose();
    EXPECT_FALSE(result.inertial) << signs.transpose();
    EXPECT_THAT(result.fit.verdict, HasSubstr("rotation to the IMU is not"));
    EXPECT_THAT(result.fit.verdict, HasSubstr("for the magnetometer alone"));
  }
}

TEST(AxisChecks, NameAGyroscopeWithExchangedAxes) {
  MagnetometerRecord record = turnedRecord();
  for (ImuSample& sample : record.imu)
    std::swap(sample.angular_velocity_B.x(), sample.angular_velocity_B.z());
  Diagnostics diagnostics;
  calibrateMagnetometer(record, {}, &diagnostics);
  EXPECT_EQ(diagnostics.count("gyroscope_axes"), 1);
}

TEST(AxisChecks, NameAReversedAccelerometerByTheDip) {
  MagnetometerRecord record = turnedRecord();
  for (ImuSample& sample : record.imu) sample.specific_force_B *= -1.0;
  Diagnostics diagnostics;
  calibrateMagnetometer(record, {}, &diagnostics);
  EXPECT_EQ(diagnostics.count("magnetometer_reversed"), 1);
}

TEST(AxisChecks, BelieveASouthernSite) {
  test::TurningSensor sensor;
  sensor.duration_s = 40.0;
  sensor.motion.a = Vec3(2.2, -0.9, 1.3);
  sensor.motion.b = Vec3(-1.1, 1.9, 0.8);
  sensor.imu_rate_hz = 400.0;
  sensor.truth.dip_rad = -1.0;
  MagnetometerRecord record;
  for (const NormalizedFieldSample& sample : sensor.field())
    record.magnetometer.push_back({sample.time, kTurnedField_T * sample.field_M});
  record.imu = sensor.imu();
  record.imu_noise.gyroscope_density_rad_per_s_sqrtHz = sensor.gyroscope_density;
  CalibrationOptions options;
  options.site_field_ENU = Vec3(kSite_ENU.x(), kSite_ENU.y(), -kSite_ENU.z());
  Diagnostics diagnostics;
  calibrateMagnetometer(record, options, &diagnostics);
  EXPECT_TRUE(diagnostics.ranked().empty());
}

}  // namespace
}  // namespace lodeline

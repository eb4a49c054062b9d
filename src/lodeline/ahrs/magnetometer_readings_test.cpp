#include "lodeline/ahrs/magnetometer_readings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

class MagnetometerReadingsTest : public testing::Test {
 protected:
  // A sensor that rotates at 1 rad/s in a field of 45 uT, in the given unit.
  static std::vector<MagnetometerSample> turning(double seconds, double tesla_per_unit = 1.0,
                                                 double rate_hz = 50.0) {
    std::vector<MagnetometerSample> readings;
    for (double t = 0.0; t < seconds; t += 1.0 / rate_hz) {
      const Vec3 field = so3::exp(t * Vec3(0.6, 0.64, 0.48)).conjugate() * Vec3(0.0, 24e-6, -38e-6);
      readings.push_back({Time::fromSeconds(t), field / tesla_per_unit});
    }
    return readings;
  }

  Diagnostics diagnostics_;
  MagnetometerCalibration calibration_;
};

TEST_F(MagnetometerReadingsTest, GivesTheFieldInTheBodyFreeOfIron) {
  calibration_.body_from_magnetometer = Rigid3(so3::exp(Vec3(0.3, -0.2, 1.0)), Vec3(0.1, 0.0, 0.0));
  calibration_.iron_correction.diagonal() << 1.1, 0.9, 1.0;
  calibration_.hard_iron_T = Vec3(5e-6, -3e-6, 2e-6);
  const auto truth = turning(1.0);
  auto readings = truth;
  for (MagnetometerSample& r : readings)
    r.field_M = calibration_.iron_correction.inverse() * r.field_M + calibration_.hard_iron_T;
  const auto usable = MagnetometerReadings(calibration_, &diagnostics_).add(readings);
  ASSERT_EQ(usable.size(), truth.size());
  for (size_t i = 0; i < usable.size(); ++i) {
    EXPECT_LT((usable[i].field_B - calibration_.body_from_magnetometer.rotation * truth[i].field_M).norm(),
              1e-15);
    EXPECT_EQ(usable[i].time, truth[i].time);
  }
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(MagnetometerReadingsTest, TellsUnitsApartByTheFieldsSize) {
  const Vec3 expected = turning(0.01).front().field_M;
  for (const double unit : {1e-4, 1e-6, 1e-7, 1e-9}) {
    Diagnostics diagnostics;
    const auto usable = MagnetometerReadings(calibration_, &diagnostics).add(turning(1.0, unit));
    ASSERT_EQ(usable.size(), 50u) << unit;
    EXPECT_LT((usable.front().field_B - expected).norm(), 1e-15) << unit;
    EXPECT_EQ(diagnostics.count("magnetometer_converted"), 1) << unit;
  }
}

TEST_F(MagnetometerReadingsTest, UsesNothingThatFitsNoUnit) {
  MagnetometerReadings readings(calibration_, &diagnostics_);
  EXPECT_TRUE(readings.add(turning(1.0, 1e-5)).empty());
  EXPECT_TRUE(readings.add(turning(1.0, 1e-5)).empty());
  EXPECT_EQ(diagnostics_.count("magnetometer_unusable"), 1) << "said once";
}

TEST_F(MagnetometerReadingsTest, DropsWhatIsNoNumber) {
  auto readings = turning(1.0);
  readings[0].field_M.x() = std::numeric_limits<double>::quiet_NaN();
  readings[7].field_M.z() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(MagnetometerReadings(calibration_, &diagnostics_).add(readings).size(), 48u);
  EXPECT_EQ(diagnostics_.count("magnetometer_invalid"), 2);
}

TEST_F(MagnetometerReadingsTest, DropsRepetitionsAndNoticesAFrozenSensor) {
  auto readings = turning(4.0);
  readings[10].field_M = readings[9].field_M;
  for (size_t i = 60; i < 150; ++i) readings[i].field_M = readings[59].field_M;
  MagnetometerReadings sorted(calibration_, &diagnostics_);
  const std::span<const MagnetometerSample> all(readings);
  EXPECT_EQ(sorted.add(all.first(50)).size(), 49u);
  EXPECT_EQ(diagnostics_.count("magnetometer_frozen"), 0);
  EXPECT_EQ(sorted.add(all.subspan(50, 100)).size(), 10u);
  EXPECT_TRUE(sorted.frozen());
  EXPECT_EQ(diagnostics_.count("magnetometer_frozen"), 1);
  EXPECT_EQ(sorted.add(all.subspan(150)).size(), 50u);
  EXPECT_FALSE(sorted.frozen());
}

TEST_F(MagnetometerReadingsTest, DropsSaturatedReadings) {
  constexpr double kRange_T = 30e-6;
  auto readings = turning(10.0);
  size_t beyond = 0;
  for (MagnetometerSample& r : readings) {
    beyond += r.field_M.cwiseAbs().maxCoeff() > kRange_T;
    r.field_M = r.field_M.cwiseMax(-kRange_T).cwiseMin(kRange_T);
  }
  ASSERT_GT(beyond, 100u);
  const auto usable = MagnetometerReadings(calibration_, &diagnostics_).add(readings);
  // Until the end of the range is known, the first saturated readings pass.
  EXPECT_GT(diagnostics_.count("magnetometer_saturated"),
            static_cast<int>(0.5 * static_cast<double>(beyond)));
  EXPECT_GE(usable.size(), readings.size() - beyond);
}

TEST_F(MagnetometerReadingsTest, TakesACoarseSensorForWhatItIs) {
  constexpr double kResolution_T = 0.6e-6;
  auto readings = turning(20.0, 1.0, 1000.0);
  for (MagnetometerSample& r : readings) {
    // Rotation about a sensor axis that is parallel to the larger part of the field.
    const Vec3 level = so3::exp(r.time.seconds() * Vec3::UnitZ()) * Vec3(0.0, 24e-6, -38e-6);
    r.field_M = r.time.seconds() < 10.0 ? r.field_M : level;
    r.field_M = (r.field_M / kResolution_T).array().round().matrix() * kResolution_T;
  }
  MagnetometerReadings(calibration_, &diagnostics_).add(readings);
  EXPECT_EQ(diagnostics_.count("magnetometer_saturated"), 0);
  EXPECT_EQ(diagnostics_.count("magnetometer_frozen"), 0);
}

}  // namespace
}  // namespace lodeline

#include "lodeline/inertial/reading_unit.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {

const Vec3 kField_T(4e-6, 24e-6, -38e-6);
constexpr FieldUnit kUnits[] = {FieldUnit::Tesla, FieldUnit::Gauss, FieldUnit::Microtesla,
                                FieldUnit::Milligauss, FieldUnit::Nanotesla};

/// The unit that readings of this size are taken to have.
FieldUnit unitOf(const Vec3& reading, const MagnetometerCalibration& calibration = {}) {
  ReadingUnit unit(calibration);
  for (int i = 0; i < 3; ++i) unit.add(reading);
  return unit.unit();
}

TEST(ReadingUnit, IsToldBySize) {
  EXPECT_EQ(ReadingUnit({}).unit(), FieldUnit::Raw);
  for (const FieldUnit expected : kUnits) {
    for (const double scale : {0.5, 1.0, 1.5}) {
      EXPECT_EQ(unitOf(scale * kField_T / teslaPer(expected)), expected)
          << toString(expected) << " times " << scale;
    }
  }
}

TEST(ReadingUnit, SeesTheFieldBehindItsIron) {
  MagnetometerCalibration calibration;
  calibration.hard_iron_T = Vec3(60e-6, -70e-6, 20e-6);
  for (const FieldUnit expected : kUnits) {
    for (const double sign : {1.0, -1.0}) {
      const Vec3 reading = (sign * kField_T + calibration.hard_iron_T) / teslaPer(expected);
      EXPECT_EQ(unitOf(reading, calibration), expected) << toString(expected) << " times " << sign;
    }
  }
  // Not calibrated, yet no other unit has such figures.
  EXPECT_EQ(unitOf(kField_T + calibration.hard_iron_T), FieldUnit::Tesla);
}

TEST(ReadingUnit, IsNotThatOfAWildReading) {
  for (const double wild : {1e-9, 3.0, 1e5}) {
    ReadingUnit unit({});
    unit.add(Vec3(wild, 0.0, 0.0));
    EXPECT_EQ(unit.unit(), FieldUnit::Raw);
    EXPECT_FALSE(unit.settled());
    for (int i = 0; i < 2; ++i) unit.add(1e6 * kField_T);
    EXPECT_EQ(unit.unit(), FieldUnit::Microtesla) << wild;
  }
}

TEST(ReadingUnit, StaysOnceItIsSettled) {
  ReadingUnit unit({});
  for (int i = 0; i < 20; ++i) unit.add(1e6 * kField_T);
  EXPECT_TRUE(unit.settled());
  for (int i = 0; i < 100; ++i) unit.add(1e4 * kField_T);
  EXPECT_EQ(unit.unit(), FieldUnit::Microtesla);
}

TEST(ReadingUnit, OfNoFieldIsNone) { EXPECT_EQ(unitOf(1e5 * kField_T), FieldUnit::Raw); }

}  // namespace
}  // namespace lodeline

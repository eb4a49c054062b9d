#include "lodeline/ahrs/reading_unit.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {

const Vec3 kField_T(4e-6, 24e-6, -38e-6);
constexpr FieldUnit kUnits[] = {FieldUnit::Tesla, FieldUnit::Gauss, FieldUnit::Microtesla,
                                FieldUnit::Milligauss, FieldUnit::Nanotesla};

TEST(ReadingUnit, IsToldBySize) {
  EXPECT_EQ(ReadingUnit({}).unit(), FieldUnit::Raw);
  for (const FieldUnit expected : kUnits) {
    for (const double scale : {0.5, 1.0, 1.5}) {
      ReadingUnit unit({});
      unit.add(scale * kField_T / teslaPer(expected));
      EXPECT_EQ(unit.unit(), expected) << toString(expected) << " times " << scale;
    }
  }
}

TEST(ReadingUnit, SeesTheFieldBehindItsIron) {
  MagnetometerCalibration calibration;
  calibration.hard_iron_T = Vec3(60e-6, -70e-6, 20e-6);
  for (const FieldUnit expected : kUnits) {
    for (const double sign : {1.0, -1.0}) {
      ReadingUnit unit(calibration);
      unit.add((sign * kField_T + calibration.hard_iron_T) / teslaPer(expected));
      EXPECT_EQ(unit.unit(), expected) << toString(expected) << " times " << sign;
    }
  }
  // Not calibrated, but only tesla has values of this size.
  ReadingUnit unit({});
  unit.add(kField_T + calibration.hard_iron_T);
  EXPECT_EQ(unit.unit(), FieldUnit::Tesla);
}

TEST(ReadingUnit, IsNotThatOfAWildReading) {
  for (const double wild : {1e-9, 3.0, 1e5}) {
    ReadingUnit unit({});
    unit.add(Vec3(wild, 0.0, 0.0));
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

TEST(ReadingUnit, OfNoFieldIsNone) {
  ReadingUnit unit({});
  unit.add(1e5 * kField_T);
  EXPECT_EQ(unit.unit(), FieldUnit::Raw);
}

}  // namespace
}  // namespace lodeline

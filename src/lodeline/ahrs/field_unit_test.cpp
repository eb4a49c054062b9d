#include "lodeline/ahrs/field_unit.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lodeline {
namespace {

/// Readings of a sensor rotated to all sides in a field of magnitude 1, with hard iron three times as large
/// and soft iron.
std::vector<Vec3> turnedAbout(int count) {
  std::vector<Vec3> readings;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / count, r = std::sqrt(1.0 - z * z);
    const double golden_angle_rad = 2.399963 * i;
    readings.push_back(
        Vec3(0.95 * r * std::cos(golden_angle_rad), 1.07 * r * std::sin(golden_angle_rad), 0.91 * z) +
        Vec3(2.0, -3.0, 1.0));
  }
  return readings;
}

TEST(FieldUnit, IsToldByTheFieldsSizeDespiteHardIron) {
  for (const FieldUnit unit : {FieldUnit::Tesla, FieldUnit::Microtesla, FieldUnit::Nanotesla,
                               FieldUnit::Gauss, FieldUnit::Milligauss}) {
    for (const double field_T : {25e-6, 65e-6}) {
      std::vector<Vec3> readings = turnedAbout(300);
      for (Vec3& reading : readings) reading *= field_T / teslaPer(unit);
      EXPECT_EQ(unitBySize(fieldSize(readings)), unit) << toString(unit);
      // A single direction without hard iron.
      const std::vector<Vec3> still(20, Vec3(0.0, field_T, 0.0) / teslaPer(unit));
      EXPECT_EQ(unitBySize(fieldSize(still)), unit) << toString(unit);
    }
  }
  EXPECT_EQ(unitBySize(3500.0), FieldUnit::Raw);
  EXPECT_EQ(unitBySize(0.0), FieldUnit::Raw);
}

TEST(FieldUnit, HasNames) {
  EXPECT_EQ(fieldUnitFromString("uT"), FieldUnit::Microtesla);
  EXPECT_EQ(fieldUnitFromString("\u00b5T"), FieldUnit::Microtesla);
  EXPECT_EQ(fieldUnitFromString("mg"), FieldUnit::Milligauss);
  EXPECT_EQ(fieldUnitFromString("tesla"), std::nullopt);
}

}  // namespace
}  // namespace lodeline

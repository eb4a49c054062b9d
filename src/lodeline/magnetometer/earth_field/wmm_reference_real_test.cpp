#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>

#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"
#include "lodeline/util/files/test_data.h"

namespace lodeline {
namespace {

double angleDifferenceDeg(double a_rad, double b_deg) {
  return std::remainder(a_rad * 180.0 / std::numbers::pi - b_deg, 360.0);
}

TEST(WorldMagneticModelReference, ReproducesAllOfNoaasTestValues) {
  constexpr const char* kTestValues = "wmm/WMM2025_TestValues.txt";
  const auto table = testData(kTestValues);
  if (!table) GTEST_SKIP() << missingTestData(kTestValues);
  std::ifstream file(*table);
  int points = 0;
  double largest_nT = 0.0, largest_deg = 0.0, largest_rate_nT = 0.0;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    // Columns: year, km, latitude, longitude, D, I, H, X (north), Y (east), Z (down), F, then their rates.
    std::array<double, 18> v{};
    std::istringstream stream(line);
    for (double& value : v) stream >> value;
    if (!stream) continue;
    const MagneticField field = worldMagneticField({v[2], v[3], 1e3 * v[1]}, v[0]);
    const FieldElements e = fieldElements(field.field_ENU);
    const Vec3 expected(v[8], v[7], -v[9]), expected_rate(v[15], v[14], -v[16]);
    largest_nT = std::max(largest_nT, (1e9 * field.field_ENU - expected).cwiseAbs().maxCoeff());
    largest_nT =
        std::max({largest_nT, std::abs(1e9 * e.horizontal_T - v[6]), std::abs(1e9 * e.total_T - v[10])});
    largest_rate_nT =
        std::max(largest_rate_nT, (1e9 * field.rate_ENU_per_year - expected_rate).cwiseAbs().maxCoeff());
    largest_deg = std::max({largest_deg, std::abs(angleDifferenceDeg(e.declination_rad, v[4])),
                            std::abs(angleDifferenceDeg(e.inclination_rad, v[5]))});
    ++points;
  }
  RecordProperty("largest_nT", std::to_string(largest_nT));
  RecordProperty("largest_deg", std::to_string(largest_deg));
  RecordProperty("largest_rate_nT_per_year", std::to_string(largest_rate_nT));
  EXPECT_EQ(points, 100);
  EXPECT_LT(largest_nT, 1e-3);
  // The table's angles are rounded to 0.01 degrees.
  EXPECT_LT(largest_deg, 0.005 + 1e-9);
  EXPECT_LT(largest_rate_nT, 1e-3);
}

}  // namespace
}  // namespace lodeline

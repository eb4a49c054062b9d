#include "lodeline/ahrs/field_unit.h"

#include <array>
#include <cctype>
#include <string_view>
#include <vector>

#include "lodeline/util/median.h"

namespace lodeline {
namespace {

struct Unit {
  FieldUnit unit;
  const char* name;
  double tesla;
};
constexpr std::array<Unit, 6> kUnits = {{{FieldUnit::Tesla, "T", 1.0},
                                         {FieldUnit::Microtesla, "uT", 1e-6},
                                         {FieldUnit::Nanotesla, "nT", 1e-9},
                                         {FieldUnit::Gauss, "G", 1e-4},
                                         {FieldUnit::Milligauss, "mG", 1e-7},
                                         {FieldUnit::Raw, "raw", 1.0}}};
constexpr double kLeastField_T = 15e-6;
constexpr double kGreatestField_T = 100e-6;

std::string lowered(const std::string& text) {
  std::string result;
  for (size_t i = 0; i < text.size(); ++i) {
    const std::string_view rest = std::string_view(text).substr(i);
    if (rest.starts_with("\u00b5") || rest.starts_with("\u03bc")) {  // micro sign and mu
      result += 'u';
      ++i;
    } else {
      result += static_cast<char>(std::tolower(static_cast<unsigned char>(text[i])));
    }
  }
  return result;
}

}  // namespace

const char* toString(FieldUnit unit) {
  for (const Unit& known : kUnits) {
    if (known.unit == unit) return known.name;
  }
  return "";
}

std::optional<FieldUnit> fieldUnitFromString(const std::string& name) {
  for (const Unit& known : kUnits) {
    if (lowered(name) == lowered(known.name)) return known.unit;
  }
  return std::nullopt;
}

double teslaPer(FieldUnit unit) {
  for (const Unit& known : kUnits) {
    if (known.unit == unit) return known.tesla;
  }
  return 1.0;
}

double fieldSize(std::span<const Vec3> readings) {
  if (readings.empty()) return 0.0;
  Vec3 extents;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Vec3& reading : readings) values.push_back(reading[axis]);
    extents[axis] = orderStatistic(values, 0.99) - orderStatistic(values, 0.01);
  }
  if (extents.minCoeff() > 0.5 * extents.maxCoeff()) return extents.maxCoeff() / 2.0;
  std::vector<double> sizes;
  for (const Vec3& reading : readings) sizes.push_back(reading.norm());
  return median(std::move(sizes));
}

FieldUnit unitBySize(double field_size) {
  for (const Unit& known : kUnits) {
    const double field_T = field_size * known.tesla;
    if (known.unit != FieldUnit::Raw && field_T > kLeastField_T && field_T < kGreatestField_T)
      return known.unit;
  }
  return FieldUnit::Raw;
}

}  // namespace lodeline

#pragma once

#include <optional>
#include <span>
#include <string>

#include "lodeline/geometry/types.h"

namespace lodeline {

/// Units in which magnetometers are recorded.
enum class FieldUnit { Tesla, Microtesla, Nanotesla, Gauss, Milligauss, Raw };
const char* toString(FieldUnit unit);
/// T, uT, nT, G, mG or raw, in any case, also with the Greek letter. Nothing for another word.
std::optional<FieldUnit> fieldUnitFromString(const std::string& name);

/// Factor to tesla; 1 for raw counts.
double teslaPer(FieldUnit unit);

/// Size of the field that readings show: half their widest extent where the sensor was turned about (their
/// extents in the three axes are alike, to a factor of two), else their median size. Zero without readings.
double fieldSize(std::span<const Vec3> readings);

/// The unit in which a field of that size lies between 15 and 100 uT (the Earth's is 22 to 67 uT; the margin
/// is for hard iron and scale errors); Raw where there is none. The units' ranges do not overlap.
FieldUnit unitBySize(double field_size);

}  // namespace lodeline

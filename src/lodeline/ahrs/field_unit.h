#pragma once

#include <optional>
#include <span>
#include <string>

#include "lodeline/types.h"

namespace lodeline {

/// Units used in magnetometer recordings.
enum class FieldUnit { Tesla, Microtesla, Nanotesla, Gauss, Milligauss, Raw };
const char* toString(FieldUnit unit);
/// Parses T, uT, nT, G, mG or raw in any case, also with the Greek letter. Returns nothing for any other
/// word.
std::optional<FieldUnit> fieldUnitFromString(const std::string& name);

/// Factor to tesla; 1 for raw counts.
double teslaPer(FieldUnit unit);

/// Field magnitude estimated from readings. Where the sensor was rotated (extents in the three axes equal to
/// a factor of two), it is half their largest extent. Otherwise it is their median magnitude. Zero without
/// readings.
double fieldSize(std::span<const Vec3> readings);

/// The unit for which a field of that magnitude is between 15 and 100 uT; Raw where there is none. The
/// Earth's field has 22 to 67 uT; the margin is for hard iron and scale errors. The units' ranges do not
/// overlap.
FieldUnit unitBySize(double field_size);

}  // namespace lodeline

#pragma once

#include <string>

#include "lodeline/types.h"

namespace lodeline {

/// WGS 84 position, without a height, of coordinates on a coordinate reference system: easting and northing
/// in the unit of a grid, or latitude and longitude in degrees on a geographic datum. PROJ chooses the
/// transformation as MapGrid does. Throws UsageError where `code` is neither, or the coordinates are none.
GeodeticPosition positionOnCrs(const std::string& code, const Vec2& coordinates);

}  // namespace lodeline

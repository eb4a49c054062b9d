#pragma once

#include <optional>
#include <string>

#include "lodeline/types.h"

namespace lodeline {

/// A position as people write it.
struct StatedPlace {
  GeodeticPosition position;        ///< WGS 84; height as stated, else 0
  bool has_height = false;          ///< whether a height was stated
  std::string text;                 ///< as it was written
  std::optional<std::string> grid;  ///< code of the grid of a position on a grid: "EPSG:6372"
};

/// Position from text, in one of these notations, with the height in metres (or "33 ft") at the end:
///
///     29.83, -82.60, 10                           latitude and longitude in degrees, WGS 84
///     20°19'12"N 87°23'24"W 5     20 19.2 N, 87 23.4 W, 5     N20d19m12s W87d23m24s 5 m
///     16Q 450000 2246000 5        UTM16N 450000 2246000 5     UTM zone, easting, northing, m
///     EPSG:6372 3912345 912345 5  easting and northing in the unit of that grid
///     EPSG:4269 29.83 -82.60 10   latitude and longitude on another datum
///
/// Blanks, commas and semicolons separate. Coordinates on a grid count to the east first, whatever the order
/// of its axes. PROJ transforms them to WGS 84. `option` is for messages. Throws UsageError for anything
/// else, and where the letter S of a UTM zone may be its band or the southern hemisphere.
StatedPlace parsePlace(const std::string& text, const std::string& option);

}  // namespace lodeline

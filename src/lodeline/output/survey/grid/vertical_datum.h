#pragma once

#include <optional>
#include <string>

#include "lodeline/types.h"

namespace lodeline {

/// The level that heights count from.
struct VerticalDatum {
  std::string name;                      ///< "EGM96 height (EPSG:5773)"; empty where nobody stated it
  std::optional<double> geoid_height_m;  ///< of the level above the WGS 84 ellipsoid, where it is known
  bool lacks_grid_file = false;          ///< PROJ lacks the file that gives the geoid height
};

/// `stated`: "ellipsoid", a code or a name of a vertical coordinate reference system ("EPSG:5703", "NAVD88
/// height"), or nothing. PROJ gives the geoid height where the file of its grid is installed. Throws
/// UsageError for what is no vertical system.
VerticalDatum verticalDatum(const std::string& stated, const GeodeticPosition& place);

}  // namespace lodeline

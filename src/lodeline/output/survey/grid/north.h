#pragma once

#include <optional>
#include <string>

#include "lodeline/estimate.h"
#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"

namespace lodeline {

/// Rotation of a run's world to one whose y axis points to true north.
struct North {
  double turn_rad = 0.0;                 ///< clockwise: true azimuth = azimuth in the run's world + this
  bool is_true = false;                  ///< whether the map's north is true north
  std::string text;                      ///< description for headers
  std::string axes = "east, north, up";  ///< of the map, in words
};

/// `turn_deg`: rotation stated by the user; it replaces everything else. Without it, magnetic north is
/// corrected by the declination where position and date are known. Throws UsageError where a position is
/// given but north cannot be determined, and InputError where the field model does not cover the date.
North findNorth(HeadingReference reference, const std::optional<GeodeticPosition>& place,
                const std::string& date, std::optional<double> turn_deg);

}  // namespace lodeline

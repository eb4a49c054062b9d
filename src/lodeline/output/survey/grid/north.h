#pragma once

#include <optional>
#include <string>

#include "lodeline/estimator/options/magnetometer_options.h"
#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"

namespace lodeline {

/// How a run's world is turned so that its y axis points to true north.
struct North {
  double turn_rad = 0.0;                 ///< clockwise: true azimuth = azimuth in the run's world + this
  bool is_true = false;                  ///< whether north of the map is true north
  std::string text;                      ///< the same in words, for headers
  std::string axes = "east, north, up";  ///< of the map, in words
};

/// `turn_deg`: what the user says; it replaces everything else. Without it, magnetic north is turned by the
/// declination where place and date are known. Throws UsageError where a place is given but north
/// cannot be had, and InputError where the model does not cover the date.
North findNorth(HeadingReference reference, const std::optional<GeodeticPosition>& place,
                const std::string& date, std::optional<double> turn_deg);

}  // namespace lodeline

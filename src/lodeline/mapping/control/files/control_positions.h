#pragma once

#include "lodeline/mapping/control/files/control_set.h"

namespace lodeline {

/// A position on the grid of a file (easting, northing, altitude, m) in the map frame. Throws InputError
/// where it is farther from the map's origin than kFarthestControl_m.
PositionPrior onMap(const Vec3& grid_position, const ControlReadOptions& options,
                    const ControlReadOptions::Sigmas& sigmas);

/// A position in degrees in the map frame: east, north, up in the plane that touches the ellipsoid at the
/// site (GeographicLib's LocalCartesian). Throws UsageError where the site is unknown, InputError where the
/// position is impossible or farther than kFarthestControl_m.
PositionPrior onMap(const GeodeticPosition& position, const ControlReadOptions& options,
                    const ControlReadOptions::Sigmas& sigmas);

}  // namespace lodeline

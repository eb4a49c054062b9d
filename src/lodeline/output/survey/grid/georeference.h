#pragma once

#include <GeographicLib/LocalCartesian.hpp>

#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"
#include "lodeline/output/survey/grid/map_grid.h"
#include "lodeline/types.h"

namespace lodeline {

/// Transforms a map in east, north, up (m, true north, origin anywhere near the ground) to coordinates on the
/// Earth.
///
/// Latitude and longitude are those of the point in the tangential plane of the ellipsoid's parallel surface
/// at the origin (GeographicLib's LocalCartesian). PROJ computes grid coordinates from them, so meridian
/// convergence and grid scale are exact at every point, not only at the origin. Heights are along the plumb
/// line, z above the origin's height: gravity and water pressure tie an estimate to level surfaces, which
/// deviate from the plane by 8 cm in a kilometre.
class Georeference {
 public:
  /// Throws UsageError where the origin has no coordinates on the grid, or where lengths on it differ by more
  /// than 2 % from those on the ground.
  Georeference(const GeodeticPosition& origin, const MapGrid& grid);

  const GeodeticPosition& origin() const { return origin_; }
  const MapGridDescription& gridDescription() const { return grid_.description(); }

  /// Height relative to the same level as that of the origin.
  GeodeticPosition geodetic(const Vec3& point_ENU) const;
  /// Easting, northing, height in metres, also if the unit of the grid is feet.
  Vec3 grid(const Vec3& point_ENU) const;

  /// Angle from true north to grid north, clockwise, at the origin: true azimuth = grid azimuth + this.
  double convergence_rad() const { return convergence_rad_; }
  /// Metres of the grid per metre on the ellipsoid, at the origin.
  double scale() const { return scale_; }

 private:
  GeodeticPosition origin_;
  MapGrid grid_;
  GeographicLib::LocalCartesian plane_;
  double convergence_rad_ = 0.0;
  double scale_ = 1.0;
};

/// The vector with its azimuth increased by the angle: rotated clockwise seen from above.
Vec3 turnedClockwise(const Vec3& vector, double angle_rad);

}  // namespace lodeline

#include "lodeline/output/survey/grid/georeference.h"

#include <fmt/format.h>

#include <cmath>

#include "lodeline/diagnostics.h"

namespace lodeline {

Georeference::Georeference(const GeodeticPosition& origin, const MapGrid& grid)
    : origin_(origin), grid_(grid), plane_(origin.latitude_deg, origin.longitude_deg, origin.height_m) {
  constexpr double kStep_m = 50.0, kMostScaleError = 0.02;
  const Vec3 north = this->grid(Vec3(0.0, kStep_m, 0.0)) - this->grid(Vec3(0.0, -kStep_m, 0.0));
  scale_ = north.head<2>().norm() / (2.0 * kStep_m);
  if (!(std::abs(scale_ - 1.0) <= kMostScaleError)) {
    const MapGridDescription& description = grid_.description();
    throw UsageError(
        fmt::format("{:.5f}, {:.5f} cannot be given in {} ({}, {}): a metre there has {:.3f} m on it; leave "
                    "--crs out for "
                    "the UTM zone of the entrance, and check latitude and longitude",
                    origin.latitude_deg, origin.longitude_deg, description.name, description.title,
                    description.area, scale_));
  }
  convergence_rad_ = -std::atan2(north.x(), north.y());
}

GeodeticPosition Georeference::geodetic(const Vec3& point_ENU) const {
  GeodeticPosition position;
  double height_above_plane_m;
  plane_.Reverse(point_ENU.x(), point_ENU.y(), point_ENU.z(), position.latitude_deg, position.longitude_deg,
                 height_above_plane_m);
  position.height_m = origin_.height_m + point_ENU.z();
  return position;
}

Vec3 Georeference::grid(const Vec3& point_ENU) const {
  const GeodeticPosition position = geodetic(point_ENU);
  const Vec2 horizontal = grid_.project(position.latitude_deg, position.longitude_deg);
  return {horizontal.x(), horizontal.y(), position.height_m};
}

Vec3 turnedClockwise(const Vec3& vector, double angle_rad) {
  return Eigen::AngleAxisd(-angle_rad, Vec3::UnitZ()) * vector;
}

}  // namespace lodeline

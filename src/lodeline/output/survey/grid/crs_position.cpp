#include "lodeline/output/survey/grid/crs_position.h"

#include <fmt/format.h>

#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/output/survey/grid/map_grid.h"
#include "lodeline/output/survey/grid/proj_objects.h"

namespace lodeline {
namespace {

/// Rough position, by the transformation that PROJ takes for the whole area.
GeodeticPosition roughPosition(const ProjObjects& proj, PJ* crs, const Vec2& east_north) {
  const ProjObjects::Object wgs84 = proj.create("EPSG:4326");
  const ProjObjects::Object plain(
      proj_create_crs_to_crs_from_pj(proj.context.get(), crs, wgs84.get(), nullptr, nullptr));
  if (plain == nullptr) return {HUGE_VAL, HUGE_VAL, 0.0};
  if (areWestAndSouth(proj.axisDirections(crs))) {
    const PJ_COORD found =
        proj_trans(plain.get(), PJ_FWD, proj_coord(east_north.x(), east_north.y(), 0.0, HUGE_VAL));
    return {found.lp.lam, found.lp.phi, 0.0};  // in the order of EPSG: the latitude first
  }
  const ProjObjects::Object normal(proj_normalize_for_visualization(proj.context.get(), plain.get()));
  const PJ_COORD found =
      proj_trans(normal.get(), PJ_FWD, proj_coord(east_north.x(), east_north.y(), 0.0, HUGE_VAL));
  return {found.lp.phi, found.lp.lam, 0.0};
}

}  // namespace

GeodeticPosition positionOnCrs(const std::string& code, const Vec2& coordinates) {
  const ProjObjects proj;
  const ProjObjects::Object crs = proj.create(code);
  if (crs == nullptr) throw UsageError(code + " is unknown to PROJ");
  const PJ_TYPE type = proj_get_type(crs.get());
  const bool is_geographic = type == PJ_TYPE_GEOGRAPHIC_2D_CRS;
  if (!is_geographic && type != PJ_TYPE_PROJECTED_CRS) {
    throw UsageError(fmt::format("{} ({}) is no grid and no datum of latitude and longitude", code,
                                 proj_get_name(crs.get())));
  }
  const Vec2 east_north = is_geographic ? Vec2(coordinates.y(), coordinates.x()) : coordinates;
  GeodeticPosition position = roughPosition(proj, crs.get(), east_north);
  if (std::abs(position.latitude_deg) <= 90.0 && !is_geographic)
    position = MapGrid(code, position).locate(east_north);
  if (!(std::abs(position.latitude_deg) <= 90.0) || !std::isfinite(position.longitude_deg)) {
    throw UsageError(fmt::format("{:g}, {:g} is no place on {} ({})", coordinates.x(), coordinates.y(), code,
                                 proj_get_name(crs.get())));
  }
  return position;
}

}  // namespace lodeline

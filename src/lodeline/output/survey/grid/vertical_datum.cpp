#include "lodeline/output/survey/grid/vertical_datum.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/output/survey/grid/proj_objects.h"

namespace lodeline {
namespace {

/// Height of the level above the ellipsoid, m; nothing where PROJ lacks the grid of the geoid.
std::optional<double> geoidHeight_m(const ProjObjects& proj, const std::string& code,
                                    const GeodeticPosition& place) {
  const ProjObjects::Object from = proj.create("EPSG:4326+" + code), to = proj.create("EPSG:4979");
  if (from == nullptr || to == nullptr) return std::nullopt;
  constexpr std::array<const char*, 2> kOptions = {"ALLOW_BALLPARK=NO", nullptr};
  const ProjObjects::Object way(
      proj_create_crs_to_crs_from_pj(proj.context.get(), from.get(), to.get(), nullptr, kOptions.data()));
  if (way == nullptr) return std::nullopt;
  const ProjObjects::Object normal(proj_normalize_for_visualization(proj.context.get(), way.get()));
  const PJ_COORD found =
      proj_trans(normal.get(), PJ_FWD, proj_coord(place.longitude_deg, place.latitude_deg, 0.0, HUGE_VAL));
  // An unknown geoid gives zero or nothing.
  if (!std::isfinite(found.xyz.z) || found.xyz.z == 0.0) return std::nullopt;
  return found.xyz.z;
}

}  // namespace

VerticalDatum verticalDatum(const std::string& stated, const GeodeticPosition& place) {
  VerticalDatum datum;
  if (stated.empty()) return datum;
  if (stated == "ellipsoid") return {"WGS 84 ellipsoid", 0.0, false};
  const ProjObjects proj;
  const ProjObjects::Object crs = proj.create(stated);
  if (crs == nullptr || proj_get_type(crs.get()) != PJ_TYPE_VERTICAL_CRS) {
    throw UsageError(
        fmt::format("--vertical-datum {}: a vertical system of EPSG is wanted, as EPSG:5703 (NAVD88), "
                    "EPSG:5773 (EGM96) or ellipsoid",
                    stated));
  }
  const std::string code =
      textOf(proj_get_id_auth_name(crs.get(), 0)) + ":" + textOf(proj_get_id_code(crs.get(), 0));
  datum.name = fmt::format("{} ({})", textOf(proj_get_name(crs.get())), code);
  datum.geoid_height_m = geoidHeight_m(proj, textOf(proj_get_id_code(crs.get(), 0)), place);
  datum.lacks_grid_file = !datum.geoid_height_m;
  return datum;
}

}  // namespace lodeline

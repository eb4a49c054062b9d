#include "lodeline/output/survey/grid/map_grid.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <proj_experimental.h>

#include <GeographicLib/UTMUPS.hpp>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/output/survey/grid/proj_objects.h"

namespace lodeline {
namespace {

using GeographicLib::UTMUPS;

constexpr double kSame_m = 1e-3;  ///< difference of coordinates of one position on equal grids

/// PROJ's code of a grid's name: "EPSG:32617" for "utm17n" or "17N"; other names in upper case.
std::string codeOf(const std::string& crs, const GeodeticPosition& place) {
  std::string code = crs;
  std::transform(code.begin(), code.end(), code.begin(), [](unsigned char c) { return std::toupper(c); });
  if (code.find(':') != std::string::npos) return code;
  try {
    int zone = 0;
    bool north = place.latitude_deg >= 0.0;
    if (code == "AUTO") {
      if (!(std::abs(place.latitude_deg) <= 90.0)) return code;
      zone = UTMUPS::StandardZone(place.latitude_deg, place.longitude_deg);
    } else {
      UTMUPS::DecodeZone(code.starts_with("UTM") ? code.substr(3) : code, zone, north);
    }
    if (zone >= UTMUPS::MINUTMZONE && zone <= UTMUPS::MAXUTMZONE)
      return fmt::format("EPSG:{}", UTMUPS::EncodeEPSG(zone, north));
    // Universal Polar Stereographic with the easting first.
    if (code == "AUTO" && zone == UTMUPS::UPS) return north ? "EPSG:5041" : "EPSG:5042";
  } catch (const GeographicLib::GeographicErr&) {  // named below
  }
  return code;
}

/// Name of a code: "UTM17N" for EPSG:32617, the code itself for all others.
std::string nameOf(const std::string& code) {
  int zone = UTMUPS::INVALID;
  bool north = false;
  if (code.starts_with("EPSG:")) UTMUPS::DecodeEPSG(std::atoi(code.c_str() + 5), zone, north);
  const bool is_utm = zone >= UTMUPS::MINUTMZONE && zone <= UTMUPS::MAXUTMZONE;
  return is_utm ? fmt::format("UTM{}{}", zone, north ? "N" : "S") : code;
}

/// The name of a transformation without its steps that only exchange axes.
std::string withoutAxisOrder(std::string name) {
  const std::string step = "axis order change (2D)";
  for (const std::string& text : {step + " + ", " + " + step}) {
    for (size_t at = name.find(text); at != std::string::npos; at = name.find(text))
      name.erase(at, text.size());
  }
  return name;
}

/// Result of the transformation from WGS 84, in the grid's own unit; infinite where there is none.
Vec2 transformed(PJ* grid_from_wgs84, double latitude_deg, double longitude_deg) {
  const PJ_COORD result =
      proj_trans(grid_from_wgs84, PJ_FWD, proj_coord(longitude_deg, latitude_deg, 0.0, HUGE_VAL));
  proj_errno_reset(grid_from_wgs84);
  return {result.xy.x, result.xy.y};
}

/// Name in Therion's spelling: "UTM17", "UTM55S", "EPSG:6372".
std::string therionSpelling(std::string name) {
  if (name.starts_with("UTM") && name.ends_with('N')) name.pop_back();
  return name;
}

}  // namespace

/// PROJ's objects of one grid, with their own context.
struct MapGrid::Proj : ProjObjects {
  Object crs, grid_from_wgs84;
  /// Easting and northing from what the transformation gives.
  Eigen::Matrix2d east_north_from_axes = Eigen::Matrix2d::Identity();
  bool is_south_first = false;

  /// The transformation that PROJ suggests at a position: among all known ones, or among those whose grid
  /// files are installed. Empty where there is none.
  Object suggested(const PJ* from, const PJ* to, const GeodeticPosition& place,
                   bool with_missing_files) const {
    const std::unique_ptr<PJ_OPERATION_FACTORY_CONTEXT, Destroy> factory(
        proj_create_operation_factory_context(context.get(), nullptr));
    proj_operation_factory_context_set_spatial_criterion(context.get(), factory.get(),
                                                         PROJ_SPATIAL_CRITERION_PARTIAL_INTERSECTION);
    proj_operation_factory_context_set_grid_availability_use(
        context.get(), factory.get(),
        with_missing_files ? PROJ_GRID_AVAILABILITY_IGNORED
                           : PROJ_GRID_AVAILABILITY_DISCARD_OPERATION_IF_MISSING_GRID);
    const ObjectList list(proj_create_operations(context.get(), from, to, factory.get()));
    if (list == nullptr || proj_list_get_count(list.get()) == 0) return nullptr;
    const int index =
        proj_get_suggested_operation(context.get(), list.get(), PJ_FWD,
                                     proj_coord(place.latitude_deg, place.longitude_deg, 0.0, HUGE_VAL));
    return Object(proj_list_get(context.get(), list.get(), std::max(index, 0)));
  }

  /// The best transformation to a grid, from degrees of longitude and latitude to easting and northing.
  Object best(const PJ* grid, const GeodeticPosition& place) const {
    const Object operation = suggested(create("EPSG:4326").get(), grid, place, false);
    if (operation == nullptr) return nullptr;
    return Object(proj_normalize_for_visualization(context.get(), operation.get()));
  }

  void describeUnit(MapGridDescription* grid, const std::string& crs_name) const {
    const Object axes(proj_crs_get_coordinate_system(context.get(), crs.get()));
    const char* unit = nullptr;
    proj_cs_get_axis_info(context.get(), axes.get(), 0, nullptr, nullptr, nullptr, &grid->metres_per_unit,
                          &unit, nullptr, nullptr);
    grid->unit = textOf(unit);
    const std::string directions = axisDirections(crs.get());
    grid->counts_west_and_south = areWestAndSouth(directions);
    if (grid->counts_west_and_south) return;
    // About a pole, both axes point to the north or to the south, along two meridians.
    for (const char* usual : {"east north", "north east", "north north", "south south"}) {
      if (directions == usual) return;
    }
    throw UsageError(
        fmt::format("--crs {}: the axes of {} point {} and not to the east and north, which survey programs "
                    "take them for",
                    crs_name, grid->title, directions));
  }

  /// For a grid that counts to the west and south. PROJ may exchange its axes, so a step to the east tells
  /// which one is the westing.
  void turnToEastAndNorth(const GeodeticPosition& place) {
    constexpr double kStep_deg = 1e-3;
    const Vec2 step =
        transformed(grid_from_wgs84.get(), place.latitude_deg, place.longitude_deg + kStep_deg) -
        transformed(grid_from_wgs84.get(), place.latitude_deg, place.longitude_deg);
    east_north_from_axes = -Eigen::Matrix2d::Identity();
    if (std::abs(step.y()) > std::abs(step.x())) east_north_from_axes << 0, -1, -1, 0;
    is_south_first = axisDirections(crs.get()) == "south west";
  }

  /// PROJ string of a grid without the directions of its axes, which are then east and north.
  std::string withoutDirections(const PJ* grid) const {
    std::string text = textOf(proj_as_proj_string(context.get(), grid, PJ_PROJ_4, nullptr));
    const size_t at = text.find(" +axis=");
    if (at != std::string::npos) text.erase(at, text.find(' ', at + 1) - at);
    return text;
  }

  void describeArea(MapGridDescription* grid, const GeodeticPosition& place) const {
    double west_deg, south_deg, east_deg, north_deg;
    const char* area = nullptr;
    if (!proj_get_area_of_use(context.get(), crs.get(), &west_deg, &south_deg, &east_deg, &north_deg, &area))
      return;
    grid->area = textOf(area);
    const double width_deg = east_deg < west_deg ? east_deg + 360.0 - west_deg : east_deg - west_deg;
    const double from_west_deg = std::remainder(place.longitude_deg - west_deg, 360.0);
    grid->is_outside_area = place.latitude_deg < south_deg || place.latitude_deg > north_deg ||
                            (from_west_deg < 0.0 ? from_west_deg + 360.0 : from_west_deg) > width_deg;
  }

  void describeOperation(MapGridDescription* grid, const GeodeticPosition& place) const {
    grid->operation = withoutAxisOrder(textOf(proj_pj_info(grid_from_wgs84.get()).description));
    const double accuracy_m = proj_coordoperation_get_accuracy(context.get(), grid_from_wgs84.get());
    const bool is_guess =
        proj_coordoperation_has_ballpark_transformation(context.get(), grid_from_wgs84.get()) != 0;
    if (accuracy_m >= 0.0 && !is_guess) grid->accuracy_m = accuracy_m;
    const Object first = suggested(create("EPSG:4326").get(), crs.get(), place, true);
    grid->lacks_grid_file =
        first != nullptr && proj_coordoperation_is_instantiable(context.get(), first.get()) == 0;
  }

  /// Code of the same grid in metres, found in EPSG by the name without its unit; empty without one.
  std::string codeInMetres(const MapGridDescription& grid, const GeodeticPosition& place) const {
    const PJ_TYPE type = PJ_TYPE_PROJECTED_CRS;
    const std::string title = grid.title.substr(0, grid.title.rfind(" (ft"));
    const ObjectList list(
        proj_create_from_name(context.get(), "EPSG", title.c_str(), &type, 1, 0, 1, nullptr));
    if (list == nullptr || proj_list_get_count(list.get()) == 0) return "";
    const Object twin(proj_list_get(context.get(), list.get(), 0));
    const Object twin_from_wgs84 = best(twin.get(), place);
    if (twin_from_wgs84 == nullptr) return "";
    const Vec2 in_metres = transformed(twin_from_wgs84.get(), place.latitude_deg, place.longitude_deg);
    if (!((in_metres - grid.metres_per_unit * coordinates(place)).norm() < kSame_m)) return "";
    return fmt::format("EPSG:{}", textOf(proj_get_id_code(twin.get(), 0)));
  }

  /// Easting and northing in the grid's own unit.
  Vec2 coordinates(const GeodeticPosition& place) const {
    return east_north_from_axes * transformed(grid_from_wgs84.get(), place.latitude_deg, place.longitude_deg);
  }

  /// Whether another grid has the coordinates of this one, counted to the east and north, at a position.
  bool isTurned(const PJ* other, const GeodeticPosition& place) const {
    const Object plain(proj_create_crs_to_crs_from_pj(context.get(), crs.get(), other, nullptr, nullptr));
    if (plain == nullptr) return false;
    const Object other_from_axes(proj_normalize_for_visualization(context.get(), plain.get()));
    if (other_from_axes == nullptr) return false;
    const Vec2 axes = transformed(grid_from_wgs84.get(), place.latitude_deg, place.longitude_deg);
    const PJ_COORD found =
        proj_trans(other_from_axes.get(), PJ_FWD, proj_coord(axes.x(), axes.y(), 0.0, HUGE_VAL));
    return (Vec2(found.xy.x, found.xy.y) - coordinates(place)).norm() < kSame_m;
  }

  /// Whether Therion 6.1 computes with a grid as PROJ does. It takes longitudes from Greenwich for the
  /// convergence of the meridians. For Krovak's projection it has transformations of its own, which need a
  /// grid file.
  bool isUsedByTherion() const {
    const Object meridian(proj_get_prime_meridian(context.get(), crs.get()));
    double longitude = 0.0;
    if (meridian != nullptr) {
      proj_prime_meridian_get_parameters(context.get(), meridian.get(), &longitude, nullptr, nullptr);
    }
    return longitude == 0.0 && withoutDirections(crs.get()).find("+proj=krovak") == std::string::npos;
  }

  /// A grid that counts to the west and south as one that counts to the east and north, with the same datum
  /// and parameters. A method of EPSG includes the directions, so the conversion is that of the PROJ string
  /// without them.
  Object turned(const MapGridDescription& grid) const {
    Object plain = create(withoutDirections(crs.get()));
    if (plain != nullptr && proj_get_type(plain.get()) == PJ_TYPE_BOUND_CRS)
      plain = Object(proj_get_source_crs(context.get(), plain.get()));
    const Object conversion(plain == nullptr ? nullptr
                                             : proj_crs_get_coordoperation(context.get(), plain.get()));
    if (conversion == nullptr) return nullptr;
    const Object datum(proj_crs_get_geodetic_crs(context.get(), crs.get()));
    const Object axes(proj_create_cartesian_2D_cs(context.get(), PJ_CART2D_EASTING_NORTHING,
                                                  grid.unit.c_str(), grid.metres_per_unit));
    const std::string name = grid.title + ", counted to the east and north";
    return Object(
        proj_create_projected_crs(context.get(), name.c_str(), datum.get(), conversion.get(), axes.get()));
  }

  /// Names a grid that counts to the west and south for programs, as turned().
  void describeTurned(MapGridDescription* grid, const GeodeticPosition& place) const {
    const Object east_north = turned(*grid);
    if (east_north == nullptr || !isTurned(east_north.get(), place))
      throw UsageError(fmt::format("--crs {}: {} counts to the west and south, and PROJ cannot turn its axes",
                                   grid->name, grid->title));
    const ObjectList equal(proj_identify(context.get(), east_north.get(), "EPSG", nullptr, nullptr));
    const int count = equal == nullptr ? 0 : proj_list_get_count(equal.get());
    for (int i = 0; i < count && grid->turned_code.empty(); ++i) {
      const Object candidate(proj_list_get(context.get(), equal.get(), i));
      if (!areWestAndSouth(axisDirections(candidate.get())) && isTurned(candidate.get(), place))
        grid->turned_code = fmt::format("EPSG:{}", textOf(proj_get_id_code(candidate.get(), 0)));
    }
    const char* const options[] = {"MULTILINE=NO", nullptr};
    grid->gis_name = grid->turned_code.empty()
                         ? textOf(proj_as_wkt(context.get(), east_north.get(), PJ_WKT2_2019, options))
                         : grid->turned_code;
  }

  /// PROJ string of the grid in metres, counted to the east and north. It states the datum by the shift to
  /// WGS 84 at a position where PROJ knows one of three or seven parameters.
  std::string projString(const GeodeticPosition& place) const {
    const Object axes(
        proj_crs_alter_cs_linear_unit(context.get(), crs.get(), "metre", 1.0, nullptr, nullptr));
    const Object metric(
        proj_crs_alter_parameters_linear_unit(context.get(), axes.get(), "metre", 1.0, nullptr, nullptr, 1));
    std::string text = withoutDirections(metric.get());
    if (text.find("+towgs84") != std::string::npos || text.find("+datum") != std::string::npos) return text;
    const Object datum(proj_crs_get_geodetic_crs(context.get(), crs.get()));
    const Object shift = suggested(datum.get(), create("EPSG:4326").get(), place, false);
    std::array<double, 7> values{};
    const bool is_known = shift != nullptr && proj_coordoperation_get_towgs84_values(
                                                  context.get(), shift.get(), values.data(), 7, 0) != 0;
    const size_t at = text.find(" +units");
    if (is_known && at != std::string::npos)
      text.insert(at, fmt::format(" +towgs84={:g}", fmt::join(values, ",")));
    return text;
  }

  void describeNames(MapGridDescription* grid, const GeodeticPosition& place) const {
    std::string code = grid->name;
    grid->gis_name = grid->code;
    if (grid->counts_west_and_south) {
      describeTurned(grid, place);
      code = grid->turned_code;
    }
    if (!code.empty() && std::abs(grid->metres_per_unit - 1.0) > 1e-12) code = codeInMetres(*grid, place);
    grid->survex_name = code.empty() ? fmt::format("custom \"{}\"", projString(place)) : code;
    if (!code.empty() && !grid->lacks_grid_file && isUsedByTherion())
      grid->therion_name = therionSpelling(code);
  }
};

MapGrid::MapGrid(const std::string& crs, const GeodeticPosition& place) : proj_(std::make_shared<Proj>()) {
  const std::string code = codeOf(crs, place);
  const auto refuse = [&](const std::string& why) {
    throw UsageError(fmt::format("--crs {}: {}", crs, why));
  };
  if (code.starts_with("EPSG:") || code.starts_with("ESRI:")) proj_->crs = proj_->create(code);
  if (code == "AUTO") {
    refuse(fmt::format(
        "latitude {:g}, longitude {:g} is no place: are latitude and longitude swapped? Else name a grid",
        place.latitude_deg, place.longitude_deg));
  }
  if (proj_->crs == nullptr) refuse("a projected grid is wanted, as UTM17N, EPSG:32617 or EPSG:6372");
  description_.code = code;
  description_.name = nameOf(code);
  description_.title = textOf(proj_get_name(proj_->crs.get()));
  if (proj_get_type(proj_->crs.get()) != PJ_TYPE_PROJECTED_CRS) {
    refuse(fmt::format("{} is no projected grid in metres or feet; name one, as UTM17N or EPSG:6372",
                       description_.title));
  }
  proj_->describeUnit(&description_, crs);
  proj_->grid_from_wgs84 = proj_->best(proj_->crs.get(), place);
  if (proj_->grid_from_wgs84 == nullptr) refuse("PROJ knows no way from WGS 84 to " + description_.title);
  if (description_.counts_west_and_south) proj_->turnToEastAndNorth(place);
  proj_->describeArea(&description_, place);
  proj_->describeOperation(&description_, place);

  proj_->describeNames(&description_, place);
}

Vec2 MapGrid::project(double latitude_deg, double longitude_deg) const {
  return description_.metres_per_unit * proj_->coordinates({latitude_deg, longitude_deg, 0.0});
}

GeodeticPosition MapGrid::locate(const Vec2& coordinates) const {
  Vec2 east_north = coordinates;
  if (description_.counts_west_and_south)
    east_north = proj_->is_south_first ? Vec2(-coordinates.y(), -coordinates.x()) : Vec2(-coordinates);
  const Vec2 axes = proj_->east_north_from_axes.transpose() * east_north;
  const PJ_COORD result =
      proj_trans(proj_->grid_from_wgs84.get(), PJ_INV, proj_coord(axes.x(), axes.y(), 0.0, HUGE_VAL));
  proj_errno_reset(proj_->grid_from_wgs84.get());
  return {result.lp.phi, result.lp.lam, 0.0};
}

}  // namespace lodeline

#pragma once

#include <memory>
#include <optional>
#include <string>

#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"
#include "lodeline/types.h"

namespace lodeline {

/// Description of a grid for headers and survey programs.
struct MapGridDescription {
  std::string name;              ///< "UTM17N", "EPSG:6438"
  std::string code;              ///< PROJ's: "EPSG:32617", "EPSG:6438"
  std::string title;             ///< "NAD83(2011) / Florida East (ftUS)"
  std::string unit;              ///< of its coordinates: "metre", "US survey foot"
  double metres_per_unit = 1.0;  ///< m per unit

  std::string operation;             ///< PROJ's transformation from WGS 84
  std::optional<double> accuracy_m;  ///< of that transformation; empty where PROJ states none
  bool lacks_grid_file = false;      ///< a better transformation exists whose grid file is not installed
  std::string area;                  ///< area of use of the grid
  bool is_outside_area = false;      ///< whether the position is outside that area

  /// Survex's name of the grid in metres, its only unit: a code, or a PROJ string.
  std::string survex_name;
  /// Therion's name, which must be a code; empty where the grid in metres has no code, where Therion lacks a
  /// grid file, or where it would turn the grid wrongly.
  std::optional<std::string> therion_name;
  /// What GIS files state: a code, or well-known text.
  std::string gis_name;
  bool counts_west_and_south = false;
  /// EPSG's code of the same grid counted to the east and north; empty without one, and for other grids.
  std::string turned_code;
};

/// A projected grid: a UTM zone, a polar or a national grid, computed by PROJ.
///
/// PROJ chooses the best transformation from WGS 84 at the position among those whose grid files are
/// installed; nothing is downloaded. All coordinates are in metres.
///
/// Survey programs and GIS take the first coordinate for an easting and the second for a northing. A grid
/// that counts to the west and south therefore has easting = -westing and northing = -southing, and the name
/// of the grid with these axes: by EPSG's code of it, or by its definition.
class MapGrid {
 public:
  /// `crs`: "auto" for the UTM zone of the position (UPS near the poles), "UTM17N", "17N", "EPSG:6372" or
  /// "ESRI:102008", in any case. Throws UsageError where it names no projected grid with axes to east and
  /// north, to west and south, or along two meridians about a pole.
  MapGrid(const std::string& crs, const GeodeticPosition& place);

  const MapGridDescription& description() const { return description_; }

  /// Easting and northing in metres, also if the unit of the grid is feet; infinite where the position has no
  /// coordinates.
  Vec2 project(double latitude_deg, double longitude_deg) const;
  /// WGS 84 position of easting and northing in the grid's unit, or of westing and southing in the order of
  /// EPSG's axes; infinite where there is none.
  GeodeticPosition locate(const Vec2& coordinates) const;

 private:
  struct Proj;
  MapGridDescription description_;
  std::shared_ptr<Proj> proj_;
};

}  // namespace lodeline

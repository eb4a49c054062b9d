#pragma once

#include <memory>
#include <optional>
#include <string>

#include "lodeline/geometry/types.h"
#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"

namespace lodeline {

/// What headers and survey programs say about a grid.
struct MapGridDescription {
  std::string name;              ///< "UTM17N", "EPSG:6438"
  std::string code;              ///< PROJ's: "EPSG:32617", "EPSG:6438"
  std::string title;             ///< "NAD83(2011) / Florida East (ftUS)"
  std::string unit;              ///< of its coordinates: "metre", "US survey foot"
  double metres_per_unit = 1.0;  ///< m per unit

  std::string operation;             ///< PROJ's transformation from WGS 84
  std::optional<double> accuracy_m;  ///< of that transformation; nothing where PROJ states none
  bool lacks_grid_file = false;      ///< a better transformation exists whose grid file is not installed
  std::string area;                  ///< for which the grid was made
  bool is_outside_area = false;      ///< whether the place lies outside of it

  /// The name by which Survex knows the grid in metres, its only unit: a code, or a PROJ string.
  std::string survex_name;
  /// The same for Therion, which takes codes only; nothing where the grid in metres has no code, or where
  /// Therion stops because it lacks a grid file.
  std::optional<std::string> therion_name;
};

/// A projected grid on the Earth: a zone of UTM or a national grid, computed by PROJ.
///
/// PROJ chooses the transformation from WGS 84 that is best at the place among those whose grid files are
/// installed; nothing is downloaded. All coordinates are given in metres.
class MapGrid {
 public:
  /// `crs`: "auto" for the UTM zone of the place, "UTM17N", "17N", "EPSG:6372" or "ESRI:102008", in any case.
  /// Throws UsageError where it names no projected grid with axes to the east and north.
  MapGrid(const std::string& crs, const GeodeticPosition& place);

  const MapGridDescription& description() const { return description_; }

  /// Easting and northing in metres, also where the grid itself counts in feet; infinite where the place has
  /// none.
  Vec2 project(double latitude_deg, double longitude_deg) const;

 private:
  struct Proj;
  MapGridDescription description_;
  std::shared_ptr<Proj> proj_;
};

}  // namespace lodeline

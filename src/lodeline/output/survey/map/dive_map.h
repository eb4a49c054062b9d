#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/output/survey/grid/georeference.h"
#include "lodeline/output/survey/grid/north.h"
#include "lodeline/output/survey/grid/vertical_datum.h"
#include "lodeline/output/survey/map/passage.h"
#include "lodeline/output/survey/map/survey.h"
#include "lodeline/survey.h"

namespace lodeline {

/// All data of a map, in east, north, up with the first pose as origin.
struct DiveMap {
  std::string name, title, date;
  std::vector<std::string> team;
  std::vector<std::string> notes;    ///< origin and assumptions, one per line
  std::filesystem::path run_folder;  ///< as a full path

  North north;
  std::optional<Georeference> place;
  Vec3 place_sigma = Vec3::Zero();  ///< m, east, north, up
  double start_depth_m = 0.0;
  std::string start_depth_source;  ///< in words
  VerticalDatum heights;           ///< the level that heights count from
  double geoid_height_m = 0.0;     ///< of that level above the ellipsoid, 0 where it is unknown

  Trajectory trajectory;                           ///< body in ENU
  std::vector<PositionUncertainty> uncertainties;  ///< axes of ENU
  std::vector<MapLandmark> landmarks;              ///< ENU
  std::vector<Vec3> echoes_ENU;                    ///< wall points of a sonar
  Survey survey;

  /// Below the water's surface, m.
  double depth_m(const Vec3& point_ENU) const { return start_depth_m - point_ENU.z(); }
};

/// `extra_walls_W`: wall points other than landmarks (echoes of a sonar), in the run's world. Throws
/// InputError and UsageError where the run or the options do not allow a map.
DiveMap makeDiveMap(const RunFolder& run, const DiveMapOptions& options,
                    const std::vector<Vec3>& extra_walls_W, Diagnostics* diagnostics);

/// Description of a map for the notes and for a summary on the screen.
std::vector<std::string> describe(const DiveMap& map, const RunFolder& run);

}  // namespace lodeline

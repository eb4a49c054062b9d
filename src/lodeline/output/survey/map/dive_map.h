#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/output/survey/grid/georeference.h"
#include "lodeline/output/survey/grid/north.h"
#include "lodeline/output/survey/map/passage.h"
#include "lodeline/output/survey/map/survey.h"
#include "lodeline/output/survey/run/run_folder.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// Options of a map given by the user.
struct DiveMapOptions {
  std::string name;               ///< of the survey; empty for that of the run folder
  std::string title;              ///< empty for the name
  std::vector<std::string> team;  ///< names of people
  std::string date;               ///< YYYY-MM-DD; empty for that of the run or its stamps

  std::optional<GeodeticPosition>
      entrance;                   ///< the water's surface above the first pose; empty for a local map
  double entrance_sigma_m = 3.0;  ///< horizontal, per axis
  double entrance_height_sigma_m = 5.0;
  std::string crs = "auto";
  std::optional<double> turn_deg;       ///< see findNorth()
  std::optional<double> start_depth_m;  ///< of the first pose; empty for that of the run's pressure sensor
  std::string start_depth_source;       ///< its source, in words
  double geoid_height_m = 0.0;          ///< height of the vertical datum above the ellipsoid

  std::optional<double>
      relative_sigma;  ///< of the end position, relative to the length of the line; empty for that of the run
  StationOptions stations;
  PassageOptions passage;
  int min_observations = 3;  ///< minimum for a landmark that counts as a wall point
  bool is_closed = false;
  std::vector<std::string> notes;  ///< further lines for the headers
};

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
  double geoid_height_m = 0.0;

  Trajectory trajectory;                           ///< body in ENU
  std::vector<PositionUncertainty> uncertainties;  ///< axes of ENU
  std::vector<MapLandmark> landmarks;              ///< ENU
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

#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/mapping/store/map_records.h"

namespace lodeline {

/// A moment at which the rig was at a control point.
struct ControlVisit {
  std::string point;  ///< name of the control point
  std::string dive;   ///< name of the dive; empty for the dive that is being added
  /// Stamp of the recording's clock, or time since the start of the dive.
  std::optional<Time> stamp;
  std::optional<Duration> since_start;
  std::string origin;  ///< file and line
};

/// Control points, each named once, and the visits of the rig.
struct ControlSet {
  std::vector<ControlPoint> points;
  std::vector<ControlVisit> visits;
  std::map<int, double> tag_sizes_m;  ///< edge of the black square by number, where it is stated

  const ControlPoint* find(const std::string& name) const;
  /// Adds a point. One of the same name and kind gains what it lacks. Throws InputError naming both origins
  /// where they state different positions, kinds or tags.
  void add(const ControlPoint& point);
};

/// How positions in files become positions of the map, and how exact they are where a file does not say.
struct ControlReadOptions {
  /// Of the origin of the map frame; necessary for positions in degrees.
  std::optional<GeodeticPosition> site;
  /// Easting, northing, altitude of that origin on the grid of the files, m. Positions on a grid are those of
  /// the map without it.
  std::optional<Vec3> grid_origin;

  /// One sigma by kind where the file states none, m.
  struct Sigmas {
    double horizontal_m, vertical_m;
  };
  Sigmas gps{3.0, 6.0};      ///< a hand-held receiver under open sky; heights are half as good
  Sigmas station{1.0, 1.0};  ///< of a compass and tape survey, some hundred metres from the entrance
  Sigmas mark{0.1, 0.1};     ///< tags and tie-offs whose position is stated

  Sigmas sigmasOf(ControlKind kind) const;
  /// Throws UsageError for sigmas that are not positive and for an impossible site.
  void check() const;
};

/// Farthest distance of control points from the origin of the map, m: coordinates beyond are those of a grid
/// with another origin.
constexpr double kFarthestControl_m = 50e3;

/// Reads control points: a table (CSV), a Survex file (`.3d` version 8) or Survex' stations (`.pos`). The
/// page docs/reference/file-formats.md describes the columns. Throws InputError naming file and line where a
/// row cannot be used, and UsageError where an option is missing.
ControlSet readControl(const std::filesystem::path& file, const ControlReadOptions& options,
                       Diagnostics* diagnostics);

}  // namespace lodeline

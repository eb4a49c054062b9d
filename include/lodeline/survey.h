#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/estimate.h"
#include "lodeline/trajectory.h"

namespace lodeline {

/// Reported covariance of one position relative to the first, in the world of the run's trajectory.
struct PositionUncertainty {
  Time time;
  Mat3 covariance = Mat3::Zero();  ///< m^2
};

/// Results of a run that a map needs.
struct RunFolder {
  std::filesystem::path folder;
  std::string trajectory_file;                     ///< name of the file of the poses
  Trajectory trajectory;                           ///< body in W
  std::vector<PositionUncertainty> uncertainties;  ///< in the order of time; empty where unknown
  std::vector<MapLandmark> landmarks;              ///< empty where there is no file of them
  HeadingReference heading_reference = HeadingReference::Start;
  std::optional<double> heading_sigma_rad;  ///< at the end
  std::string program;                      ///< "lodeline 0.1.0"
  std::string recording;                    ///< as the user named it
  std::optional<GeodeticPosition> site;     ///< if given to the run
  std::string date;                         ///< YYYY-MM-DD, if given to the run
  std::optional<double> depth_at_origin_m;  ///< of the first pose, where the run had a pressure sensor
  /// [phi, xi] (rad, m) of each camera of the run, as in factors/calibrated_reprojection_factor.h; empty
  /// where they were not estimated.
  std::vector<Eigen::Matrix<double, 6, 1>> camera_corrections;
  std::vector<IntrinsicsCorrection>
      intrinsics_corrections;                    ///< as in factors/intrinsics_factor.h; may be empty
  std::vector<PortCorrection> port_corrections;  ///< of each camera; may be empty
};

/// What a map needs of the estimates of one run, or of its Refinement. The world turns to a north that was
/// found after the first pose. Estimates without a pose are left out. Throws InputError where none has one.
RunFolder runOf(const std::string& name, const std::vector<FrameEstimate>& estimates,
                const std::vector<MapPoint>& landmarks);

/// Reads a run folder: poses from `trajectory_refined.tum` where it exists (with `states_refined.csv` and
/// `landmarks_refined.ply`), else from `trajectory.tum`. Other missing files are reported as findings. Throws
/// InputError where there are no poses, or a file is malformed.
RunFolder readRunFolder(const std::filesystem::path& folder, Diagnostics* diagnostics);

/// Spacing of survey stations.
struct StationOptions {
  double spacing_m = 5.0;           ///< of stations on a straight path
  double bend_spacing_m = 2.0;      ///< minimum, where the path bends
  double bend_rad = 0.349;          ///< 20 degrees; smaller bends get no separate station
  double path_resolution_m = 0.25;  ///< smaller movements do not count as path length
};

/// How passage sizes and splays are measured from wall points.
struct PassageOptions {
  double half_slab_m = 2.5;      ///< along the passage, in front of a station and behind it
  double reach_m = 30.0;         ///< wall points further away are ignored
  double cone_rad = 0.524;       ///< 30 degrees about left, right, up, down
  double wide_cone_rad = 0.785;  ///< 45 degrees, where the cone holds too few points
  size_t min_cone_points = 5;    ///< minimum for a distance
  /// Quantile of the distances in a cone: the median follows neither the nearest cobble nor a point
  /// triangulated far behind the wall.
  double share = 0.5;
  size_t splay_sectors = 16;     ///< sectors about the passage's direction; at most one splay in each
  size_t min_sector_points = 3;  ///< minimum for a splay
};

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
  std::string vertical_datum;           ///< see verticalDatum(); empty where it is not stated
  std::optional<double>
      geoid_height_m;  ///< height of the vertical datum above the ellipsoid; empty for PROJ's

  std::optional<double>
      relative_sigma;  ///< of the end position, relative to the length of the line; empty for that of the run
  StationOptions stations;
  PassageOptions passage;
  int min_observations = 3;  ///< minimum for a landmark that counts as a wall point
  bool is_closed = false;
  std::vector<std::string> notes;  ///< further lines for the headers
};

/// Files of survey, GIS and 3-D programs. GeoPackage and Dxf need a library built with GDAL. Colmap needs the
/// recording's images, which only the program reads.
enum class MapFormat { Survex, Therion, GeoJson, Kml, Gpx, Ply, Csv, Tum, Colmap, GeoPackage, Dxf };

/// Writes one dive in these formats and its notes to a folder, which is made, and returns the files. Throws
/// InputError and UsageError where run or options do not allow a map, or a format needs a position or images
/// that are missing.
std::vector<std::filesystem::path> writeSurvey(const RunFolder& run, const DiveMapOptions& options,
                                               const std::vector<MapFormat>& formats,
                                               const std::filesystem::path& folder, Diagnostics* diagnostics);

}  // namespace lodeline

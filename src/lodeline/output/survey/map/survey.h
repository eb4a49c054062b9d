#pragma once

#include <optional>
#include <vector>

#include "lodeline/survey.h"
#include "lodeline/trajectory.h"

namespace lodeline {

/// Chooses the poses of a path that become survey stations, in order. The first and the last pose are
/// stations. Between them is one each `spacing_m` (straight line from station to station). A station
/// comes earlier at the sharpest point of a bend, at least `bend_spacing_m` from the station before. The
/// same holds for the farthest point before the path comes back towards that station. The angle of a
/// bend is that between the line from the station before and the path of the next `bend_spacing_m` / 2.
/// Throws InputError where the path is too short for two stations.
std::vector<size_t> chooseStations(const std::vector<Vec3>& positions, const StationOptions& options);

/// Distances from a station to the walls, m; empty where no wall is known in that direction.
struct PassageSize {
  std::optional<double> left, right, up, down;

  bool isComplete() const { return left && right && up && down; }
};

struct SurveyStation {
  Time time;
  Vec3 position_ENU = Vec3::Zero();  ///< m
  PassageSize passage;
  std::vector<Vec3> splays_ENU;  ///< wall points, m
};

/// Agreement of the ways in and out, or of the end and the start.
struct Misclosure {
  Vec3 end_from_start_ENU = Vec3::Zero();  ///< m
  double length_m = 0.0;                   ///< of the line
  /// For a dive that turned back (the end is nearer to the start than half of the distance to the farthest
  /// point): median distance from the stations of the way back to the way out, horizontal and vertical.
  std::optional<double> horizontal_between_ways_m, vertical_between_ways_m;

  double percent() const { return length_m > 0.0 ? 100.0 * end_from_start_ENU.norm() / length_m : 0.0; }
};

/// A line of stations with the values that survey programs need.
struct Survey {
  std::vector<SurveyStation> stations;  ///< named by their index
  Vec3 leg_sigma_ENU = Vec3::Zero();    ///< m, of each leg's components
  bool is_closed = false;               ///< the last station is also the first one

  size_t legs() const { return stations.size() - 1; }
  double length_m() const;
};

Misclosure misclosure(const Survey& survey);

/// Standard deviation of a leg with which all legs together give that of the end: sigma / sqrt(legs). It is
/// at least 1 mm, below which survey programs treat a leg as exact.
Vec3 legSigma(const Vec3& end_sigma, size_t legs);

}  // namespace lodeline

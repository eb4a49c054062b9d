#pragma once

#include <vector>

#include "lodeline/output/survey/map/survey.h"

namespace lodeline {

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

/// Computes the distances left, right, up and down and the splays of every station, from points on the walls
/// (ENU, m). Left and right are horizontal and normal to the passage, up and down are vertical. A splay ends
/// at a point of the map: in each sector of the plane across the passage, the one of median distance.
void measurePassage(const std::vector<Vec3>& walls_ENU, const PassageOptions& options, Survey* survey);

}  // namespace lodeline

#pragma once

#include <vector>

#include "lodeline/output/survey/map/survey.h"
#include "lodeline/survey.h"

namespace lodeline {

/// Computes the distances left, right, up and down and the splays of every station, from points on the walls
/// (ENU, m). Left and right are horizontal and normal to the passage, up and down are vertical. A splay ends
/// at a point of the map: in each sector of the plane across the passage, the one of median distance.
void measurePassage(const std::vector<Vec3>& walls_ENU, const PassageOptions& options, Survey* survey);

}  // namespace lodeline

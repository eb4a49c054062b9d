#pragma once

#include <vector>

#include "lodeline/output/survey/map/survey.h"
#include "lodeline/survey.h"

namespace lodeline {

/// Axes of the passage at a station: unit vectors along it, horizontally to its left, and normal to both.
struct PassageSection {
  Vec3 origin = Vec3::Zero();
  Vec3 along = Vec3::UnitX();
  Vec3 left = Vec3::UnitY();

  Vec3 above() const { return along.cross(left); }
};

/// The axes at every station; `along` is the mean direction of the legs that meet there. Where they are more
/// than 90 degrees apart, the dive turned round in the passage, and `along` is the direction of the first of
/// them.
std::vector<PassageSection> passageSections(const std::vector<SurveyStation>& stations);

/// Computes the distances left, right, up and down and the splays of every station, from points on the walls
/// (ENU, m). Left and right are horizontal and normal to the passage, up and down are vertical. A splay ends
/// at a point of the map: in each sector of the plane across the passage, the one of median distance.
void measurePassage(const std::vector<Vec3>& walls_ENU, const PassageOptions& options, Survey* survey);

}  // namespace lodeline

#pragma once

#include <string>
#include <vector>

#include "lodeline/output/survey/map/dive_map.h"

/// Shared functions of the writers of survey data.
namespace lodeline::survey_text {

/// Positions of stations rounded to the written precision (0.1 mm), so that sums of their differences are
/// exact.
Vec3 rounded(const Vec3& position);

/// Legs between positions, one per line: "0 1 4.0000 -3.0000 0.1000".
std::string legs(const std::vector<Vec3>& positions, const std::string& indent);

/// A splay from a station: distance, bearing and inclination as survey programs expect them.
std::string splay(size_t station, const char* target, const Vec3& vector, const std::string& indent);

/// Every note as a comment.
std::string comments(const DiveMap& map, const char* mark);

/// "E N U" of the first station, m, in a map without a place on Earth: from the map's origin at the surface.
std::string localStart(const DiveMap& map);

/// "2026.11.21" from "2026-11-21".
std::string dotted(std::string date);

/// In double quotes; those inside become single.
std::string quoted(std::string text);

}  // namespace lodeline::survey_text

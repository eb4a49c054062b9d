#pragma once

#include <string>
#include <vector>

#include "lodeline/output/survey/cave/cave_survey.h"

/// Shared functions of the writers of a cave.
namespace lodeline::cave_text {

/// Position of a station for a survey program, m.
using Positions = std::vector<Vec3>;

/// Legs of one dive, one per line, exact to the written precision: "3 4 1.0000 0.5000 0.0000". `connections`:
/// those that are no passage, or those that are.
std::string legs(const CaveSurvey& cave, const Positions& positions, size_t dive, bool connections,
                 const std::string& indent);

/// Whether the dive has legs of that kind.
bool hasLegs(const CaveSurvey& cave, size_t dive, bool connections);

/// The declination at the entrance on the day of a dive: "declination -6.38 deg on 2026-11-21 (WMM2025)", or
/// why it is not known.
std::string declinationNote(const DiveMap& dive);

/// Notes of the cave and of the first dive's place and north, as comments.
std::string comments(const CaveSurvey& cave, const char* mark);

/// Sizes of consecutive stations that are known, each sequence after `header`.
std::string passages(const CaveSurvey& cave, size_t dive, const std::string& header,
                     const std::string& indent);

/// "stated 12.00 3.00 -4.00 (east, north, up), one sigma 1.00 1.00 1.00; off by 0.12 m", or "unknown".
std::string statedText(const CaveControl& control);

}  // namespace lodeline::cave_text

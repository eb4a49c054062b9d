#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lodeline/mapping/control/files/control_set.h"

namespace lodeline {

/// A station of a survey.
struct SurvexStation {
  std::string name;              ///< with its surveys: "cave.entrance.1"
  Vec3 position = Vec3::Zero();  ///< easting, northing, altitude, m
  bool is_fixed = false;         ///< of known position before the survey
  bool is_entrance = false;
};

/// What Survex' program `cavern` made of a survey.
struct SurvexSurvey {
  std::string title;
  std::string coordinate_system;  ///< as PROJ names it; empty where the survey states none
  std::vector<SurvexStation> stations;
};

/// Whether a file begins as Survex' .3d files do.
bool isSurvex3d(const std::filesystem::path& file);

/// Reads a .3d file of version 8 (https://survex.com/docs/3dformat.htm): stations but no anonymous ones and
/// none on walls. Throws InputError naming file and byte for other versions, extended elevations and damaged
/// files.
SurvexSurvey readSurvex3d(const std::filesystem::path& file);

/// Reads the text of `survexport --pos`: a line `( easting, northing, altitude ) name` for each station.
/// Throws InputError naming file and line.
SurvexSurvey readSurvexPositions(const std::filesystem::path& file);

/// The stations as control points of kind Station, named as in the survey.
ControlSet controlOf(const SurvexSurvey& survey, const std::filesystem::path& file,
                     const ControlReadOptions& options);

}  // namespace lodeline

#pragma once

#include "apps/lodeline/survey/survey_project.h"
#include "lodeline/mapping/store/map_file.h"
#include "lodeline/output/survey/cave/cave_survey.h"

namespace lodeline {

/// The survey of all dives of a solved map, with its control points and the blind stretches of the runs. The
/// first dive gives north, the entrance is the water's surface above the origin of the map. Throws InputError
/// and UsageError where map or project do not allow a survey.
CaveSurvey caveOfMap(const MapFile& map, const SurveyProject& project, Diagnostics* diagnostics);

}  // namespace lodeline

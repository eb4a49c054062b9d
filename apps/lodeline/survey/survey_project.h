#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// One dive of a project.
struct ProjectDive {
  std::filesystem::path run;        ///< folder of `lodeline run`; empty for a dive that the map has already
  std::filesystem::path recording;  ///< with a scanning sonar, of the run; empty for none
  std::vector<std::string> rig;     ///< files that describe its rig
  std::string dive;                 ///< name in the map; without it, that of the run's folder
  std::string name, title, date;
  std::vector<std::string> team;
  std::optional<Vec3> start_ENU;  ///< m, from the origin of the map
  std::optional<double> start_sigma_m, start_sigma_up_m;
};

/// What `lodeline survey` makes one cave of.
struct SurveyProject {
  std::filesystem::path map;  ///< file of the common map; empty where it is built from the runs
  std::vector<std::filesystem::path> control;
  std::string name, title, date;
  std::vector<std::string> team;
  std::string entrance, crs = "auto", vertical_datum;
  std::vector<double> entrance_sigma_m = {3.0, 5.0};
  std::optional<double> geoid_height_m, turn_deg;
  double merge_m = 2.5, spacing_m = 5.0;
  std::vector<ProjectDive> dives;

  const ProjectDive* find(const std::string& dive) const;
};

/// Reads a project in YAML; paths in it are relative to its folder. docs/reference/file-formats.md lists the
/// keys. Throws InputError naming file and line where a key is unknown or a value is wrong.
SurveyProject readSurveyProject(const std::filesystem::path& file);

}  // namespace lodeline

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/output/survey/cave/cave_paths.h"
#include "lodeline/output/survey/map/dive_map.h"

namespace lodeline {

/// A point of known position, or a mark that was visited.
struct CaveControl {
  std::string name;
  size_t dive = 0;                   ///< of the visit
  Time time;                         ///< of the visit
  Vec3 position_ENU = Vec3::Zero();  ///< by the solution of the map, m
  std::optional<Vec3> stated_ENU;    ///< as stated, m; empty for a mark of unknown position
  Vec3 sigma_ENU = Vec3::Zero();     ///< of the stated position
};

/// A time of a dive without usable images.
struct BlindTime {
  size_t dive = 0;
  Time begin, end;
};

struct CaveSurveyOptions {
  std::string name = "cave", title;
  CavePathOptions paths;
  StationOptions stations;
  PassageOptions passage;
  int min_observations = 1;  ///< of a landmark that counts as a wall
  std::vector<BlindTime> blind;
};

struct CaveStation {
  size_t dive = 0, number = 0;  ///< its name is the number, in the survey of the dive
  SurveyStation station;
  Vec3 sigma_ENU = Vec3::Zero();  ///< of the position, relative to the first station, m
  std::vector<std::string> notes;
  bool is_entrance = false;  ///< a dive began here
};

/// Legs between consecutive stations of one passage: indices of CaveSurvey::stations.
struct CaveLegs {
  size_t dive = 0;
  std::vector<size_t> stations;
  bool is_connection = false;  ///< no passage
};

/// Two names of one place.
struct CaveEquate {
  size_t first = 0, second = 0;  ///< indices of CaveSurvey::stations
};

/// Several dives as one cave.
struct CaveSurvey {
  std::string name, title;
  std::vector<DiveMap> dives;
  std::vector<CaveStation> stations;
  std::vector<CaveLegs> legs;
  std::vector<CaveEquate> equates;
  struct Control {
    CaveControl point;
    size_t station = 0;  ///< nearest station of its dive
    std::string label;   ///< name for survey programs: "c_T4"
  };
  std::vector<Control> control;
  std::vector<std::string> notes;

  const Vec3& positionOf(size_t station) const { return stations[station].station.position_ENU; }
  double length_m() const;  ///< of all passages
};

/// Survey of dives whose trajectories are in one frame. Reports dives that meet no other. Throws InputError
/// where there is no way to survey.
CaveSurvey makeCaveSurvey(std::vector<DiveMap> dives, const std::vector<CaveControl>& control,
                          const CaveSurveyOptions& options, Diagnostics* diagnostics);

/// One file for Survex, one for Therion with its configuration, and a table of all stations. Both programs
/// find all stations where the table has them: the legs are differences of these positions.
std::string survexCave(const CaveSurvey& cave);
std::string therionCave(const CaveSurvey& cave);
std::string caveStationsCsv(const CaveSurvey& cave);

}  // namespace lodeline

#include "apps/lodeline/survey/cave_of_map.h"

#include <fmt/format.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "apps/lodeline/map/map_dives.h"
#include "apps/lodeline/shared/place_argument.h"
#include "lodeline/output/survey/formats/recording_walls.h"
#include "lodeline/output/survey/map/carried_trajectory.h"
#include "lodeline/output/survey/map/survey_name.h"
#include "lodeline/output/walls/section/wall_sections.h"
#include "lodeline/pipeline/open_recording.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

DiveMapOptions commonOptions(const MapFile& map, const SurveyProject& project, Diagnostics* diagnostics) {
  DiveMapOptions options;
  options.entrance = map.description().site;
  if (!project.entrance.empty()) options.entrance = placeFromText(project.entrance, "entrance", diagnostics);
  options.entrance_sigma_m = project.entrance_sigma_m[0];
  options.entrance_height_sigma_m = project.entrance_sigma_m[1];
  options.crs = project.crs;
  options.vertical_datum = project.vertical_datum;
  options.geoid_height_m = project.geoid_height_m;
  options.turn_deg = project.turn_deg;
  options.stations.spacing_m = project.spacing_m;
  options.min_observations = 1;  // a keyframe's point has been seen in many images
  return options;
}

/// Names for survey programs, all different.
std::vector<std::string> namesOf(const std::vector<RunFolder>& runs, const SurveyProject& project) {
  std::vector<std::filesystem::path> names;
  for (const RunFolder& run : runs) {
    const ProjectDive* row = project.find(run.folder.string());
    names.emplace_back(row != nullptr && !row->name.empty() ? row->name : run.folder.string());
  }
  return surveyNames(names);
}

/// Wall points by the sonar of a dive's recording, in the frame of the map; empty where the project names
/// none. The motion between the keyframes of the map is that of the dive's run.
std::vector<Vec3> echoesOf(const ProjectDive* row, const RunFolder& in_map, Diagnostics* diagnostics) {
  if (row == nullptr || row->recording.empty()) return {};
  EurocOptions options;
  options.with_cameras = options.needs_cameras = false;
  BagArguments bag;
  bag.rig_files = row->rig;
  const std::unique_ptr<RecordedSource> source = openRecording(row->recording, options, bag, diagnostics);
  if (!source->rig().sonar) {
    throw InputError(fmt::format("{}: has no sonar, and the survey reads nothing else of a recording",
                                 row->recording.string()));
  }
  const RunFolder run = readRunFolder(row->run, diagnostics);
  return sonarWalls(*source, carriedTrajectory(run.trajectory, in_map.trajectory), diagnostics);
}

/// The dives in the frame of the map, all turned by the north of the first one.
std::vector<DiveMap> divesOf(const MapFile& map, const SurveyProject& project, Diagnostics* diagnostics) {
  const std::vector<RunFolder> runs = runsOfMap(map);
  const std::vector<std::string> names = namesOf(runs, project);
  DiveMapOptions options = commonOptions(map, project, diagnostics);
  std::vector<DiveMap> dives;
  for (size_t i = 0; i < runs.size(); ++i) {
    const ProjectDive* row = project.find(runs[i].folder.string());
    options.name = names[i];
    options.title = row != nullptr ? row->title : "";
    options.date = row != nullptr && !row->date.empty() ? row->date : project.date;
    options.team = row != nullptr && !row->team.empty() ? row->team : project.team;
    const std::vector<Vec3> echoes = echoesOf(row, runs[i], diagnostics);
    Diagnostics repeated;  // what concerns the place is the same for all dives
    if (i > 0) options.turn_deg = dives.front().north.turn_rad / kDegree;
    dives.push_back(makeDiveMap(runs[i], options, echoes, i == 0 ? diagnostics : &repeated));
    if (i > 0) dives.back().north = dives.front().north;
  }
  return dives;
}

std::vector<CaveControl> controlOf(const MapFile& map, double turn_rad) {
  std::map<DiveId, size_t> index_of_dive;
  for (const MapDive& dive : map.dives()) index_of_dive.emplace(dive.id, index_of_dive.size());
  struct Sum {
    Vec3 position = Vec3::Zero();
    int count = 0;
    size_t dive = 0;
    Time time;
  };
  std::map<int64_t, Sum> sums;
  for (const ControlObservation& seen : map.controlObservations()) {
    const std::optional<StoredKeyframe> row = map.keyframe(seen.keyframe);
    if (!row || !row->solved) continue;
    Sum& sum = sums[seen.point];
    if (sum.count++ == 0) {
      sum.dive = index_of_dive.at(row->keyframe.dive);
      sum.time = row->keyframe.time;
    }
    sum.position += row->solved->map_from_body * seen.in_body.position;
  }
  std::vector<CaveControl> control;
  for (const ControlPoint& point : map.controlPoints()) {
    const auto found = sums.find(point.id);
    if (found == sums.end()) continue;
    CaveControl made;
    made.name = point.name;
    made.dive = found->second.dive;
    made.time = found->second.time;
    made.position_ENU = turnedClockwise(found->second.position / found->second.count, turn_rad);
    if (point.position) {
      made.stated_ENU = turnedClockwise(point.position->position, turn_rad);
      made.sigma_ENU = point.position->covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    }
    control.push_back(made);
  }
  return control;
}

/// Times without usable images, from run.json of the runs that the project names.
std::vector<BlindTime> blindTimes(const MapFile& map, const SurveyProject& project) {
  std::vector<BlindTime> times;
  const std::vector<MapDive> dives = map.dives();
  for (size_t i = 0; i < dives.size(); ++i) {
    const ProjectDive* row = project.find(dives[i].name);
    if (row == nullptr || row->run.empty()) continue;
    std::ifstream file(row->run / "run.json");
    const nlohmann::json json = nlohmann::json::parse(file, nullptr, false);
    if (!json.is_object() || !json.contains("blind_stretches")) continue;
    for (const nlohmann::json& blind : json["blind_stretches"]) {
      const Time begin =
          Time::fromNanoseconds(std::strtoll(blind.value("start_ns", "0").c_str(), nullptr, 10));
      times.push_back({i, begin, begin + Duration::fromSeconds(blind.value("duration_s", 0.0))});
    }
  }
  return times;
}

}  // namespace

CaveSurvey caveOfMap(const MapFile& map, const SurveyProject& project, Diagnostics* diagnostics) {
  for (const ProjectDive& row : project.dives) {
    if (!map.findDive(row.dive))
      throw InputError(fmt::format("{}: the map has no dive '{}'", map.path().string(), row.dive));
  }
  std::vector<DiveMap> dives = divesOf(map, project, diagnostics);
  CaveSurveyOptions options;
  options.name = project.name.empty() ? map.path().stem().string() : project.name;
  options.title = project.title;
  options.paths.merge_m = project.merge_m;
  options.stations.spacing_m = project.spacing_m;
  options.blind = blindTimes(map, project);
  const std::vector<CaveControl> control = controlOf(map, dives.front().north.turn_rad);
  CaveSurvey cave = makeCaveSurvey(std::move(dives), control, options, diagnostics);
  takeEchoSections({}, options.passage.splay_sectors, &cave);
  return cave;
}

}  // namespace lodeline

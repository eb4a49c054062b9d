#include "lodeline/pipeline/page/run_stations.h"

#include "lodeline/diagnostics.h"
#include "lodeline/output/report/page/table_json.h"
#include "lodeline/output/survey/map/passage.h"
#include "lodeline/output/survey/map/survey.h"
#include "lodeline/survey.h"

namespace lodeline {
namespace {

Survey surveyOf(const RunFolder& run, const DiveMapOptions& options) {
  std::vector<Vec3> positions;
  for (const StampedPose& pose : run.trajectory.poses) positions.push_back(pose.world_from_body.translation);
  Survey survey;
  for (const size_t i : chooseStations(positions, options.stations)) {
    SurveyStation station;
    station.time = run.trajectory.poses[i].time;
    station.position_ENU = positions[i];
    survey.stations.push_back(station);
  }
  std::vector<Vec3> walls;
  for (const MapLandmark& landmark : run.landmarks) {
    if (landmark.observations >= options.min_observations) walls.push_back(landmark.position);
  }
  measurePassage(walls, options.passage, &survey);
  return survey;
}

nlohmann::json distanceJson(const std::optional<double>& distance_m) {
  return distance_m ? shortNumber(*distance_m) : nlohmann::json(nullptr);
}

nlohmann::ordered_json stationJson(const SurveyStation& station, int64_t origin_ns) {
  nlohmann::json splays = nlohmann::json::array();
  for (const Vec3& splay : station.splays_ENU) {
    const Vec3 from_station = splay - station.position_ENU;
    splays.push_back(
        {shortNumber(from_station.x()), shortNumber(from_station.y()), shortNumber(from_station.z())});
  }
  const PassageSize& size = station.passage;
  return {
      {"t_s", shortNumber(1e-9 * static_cast<double>(station.time.nanoseconds() - origin_ns))},
      {"left_right_up_down_m",
       {distanceJson(size.left), distanceJson(size.right), distanceJson(size.up), distanceJson(size.down)}},
      {"splays_m", splays}};
}

}  // namespace

nlohmann::ordered_json runStationsJson(const std::filesystem::path& run, int64_t origin_ns) {
  Diagnostics ignored;  // `lodeline export` reports them
  try {
    const Survey survey = surveyOf(readRunFolder(run, &ignored), {});
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const SurveyStation& station : survey.stations) json.push_back(stationJson(station, origin_ns));
    return json;
  } catch (const InputError&) {
    return nullptr;
  }
}

}  // namespace lodeline

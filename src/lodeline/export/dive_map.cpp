#include "lodeline/export/dive_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "lodeline/base/error.h"
#include "lodeline/export/map_times.h"

namespace lodeline {
namespace {

/// A name that every survey program takes: letters, digits, '_' and '-'.
std::string surveyName(const DiveMapOptions& options, const std::filesystem::path& folder) {
  std::string name = options.name;
  if (name.empty()) {
    const std::filesystem::path absolute = std::filesystem::absolute(folder).lexically_normal();
    name = (absolute.has_filename() ? absolute : absolute.parent_path()).filename().string();
  }
  for (char& c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-') c = '_';
  }
  return name.empty() ? "dive" : name;
}

/// The day of a stamp, where that is known.
std::string dayOf(Time time) { return isoTime(time).value_or("").substr(0, 10); }

std::string dateOf(const RunFolder& run, const DiveMapOptions& options) {
  if (!options.date.empty()) {
    decimalYear(options.date);  // throws for what is no date
    return options.date;
  }
  return run.date.empty() ? dayOf(run.trajectory.poses.front().time) : run.date;
}

void turn(const RunFolder& run, DiveMap* map) {
  const Quat turn(Eigen::AngleAxisd(-map->north.turn_rad, Vec3::UnitZ()));
  const Rigid3 map_from_world(turn, Vec3::Zero());
  map->trajectory = run.trajectory;
  for (StampedPose& pose : map->trajectory.poses)
    pose.world_from_body = map_from_world * pose.world_from_body;
  map->uncertainties = run.uncertainties;
  const Mat3 matrix = turn.toRotationMatrix();
  for (PositionUncertainty& u : map->uncertainties) u.covariance = matrix * u.covariance * matrix.transpose();
  map->landmarks = run.landmarks;
  for (MapLandmark& landmark : map->landmarks) landmark.position = turn * landmark.position;
}

std::optional<Georeference> placeOf(const std::optional<GeodeticPosition>& entrance,
                                    const DiveMapOptions& options) {
  if (!entrance) return std::nullopt;
  if (!(std::abs(entrance->latitude_deg) <= 90.0 && std::abs(entrance->longitude_deg) <= 360.0)) {
    throw UsageError(
        fmt::format("--entrance: latitude {:g}, longitude {:g} is no place; LAT,LON,HEIGHT is wanted, in "
                    "degrees and m",
                    entrance->latitude_deg, entrance->longitude_deg));
  }
  GeodeticPosition first = *entrance;
  first.height_m -= options.start_depth_m;
  return Georeference(first, utmZone(options.crs, first));
}

/// One sigma of the last pose's position relative to the first.
Vec3 endSigma(const DiveMap& map, const DiveMapOptions& options, Diagnostics* diagnostics) {
  constexpr double kAssumedShare = 0.01;
  const double length_m = map.survey.length_m();
  if (options.relative_sigma) return Vec3::Constant(*options.relative_sigma * length_m);
  if (!map.uncertainties.empty()) {
    return map.uncertainties.back().covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  }
  diagnostics->report(Severity::Warning, "sigma_assumed",
                      "the run says nothing of its uncertainty: 1 % of the length is assumed for the end; "
                      "--relative-sigma states another");
  return Vec3::Constant(kAssumedShare * length_m);
}

void survey(const DiveMapOptions& options, const std::vector<Vec3>& extra_walls_ENU, Diagnostics* diagnostics,
            DiveMap* map) {
  std::vector<Vec3> positions;
  for (const StampedPose& pose : map->trajectory.poses) positions.push_back(pose.world_from_body.translation);
  for (size_t i : chooseStations(positions, options.stations)) {
    SurveyStation station;
    station.time = map->trajectory.poses[i].time;
    station.position_ENU = positions[i];
    map->survey.stations.push_back(station);
  }
  map->survey.is_closed = options.is_closed;
  map->survey.leg_sigma_ENU = legSigma(endSigma(*map, options, diagnostics), map->survey.legs());
  std::vector<Vec3> walls = extra_walls_ENU;
  for (const MapLandmark& landmark : map->landmarks) {
    if (landmark.sightings >= options.min_sightings) walls.push_back(landmark.position);
  }
  measurePassage(walls, options.passage, &map->survey);
}

}  // namespace

DiveMap makeDiveMap(const RunFolder& run, const DiveMapOptions& options,
                    const std::vector<Vec3>& extra_walls_W, Diagnostics* diagnostics) {
  DiveMap map;
  map.name = surveyName(options, run.folder);
  map.title = options.title.empty() ? map.name : options.title;
  map.team = options.team;
  map.date = dateOf(run, options);
  const std::optional<GeodeticPosition> entrance = options.entrance ? options.entrance : run.site;
  map.place = placeOf(entrance, options);
  map.north = findNorth(run.heading_reference, entrance, map.date, options.turn_deg);
  map.place_sigma = {options.entrance_sigma_m, options.entrance_sigma_m, options.entrance_height_sigma_m};
  map.start_depth_m = options.start_depth_m;
  map.geoid_height_m = options.geoid_height_m;
  turn(run, &map);
  std::vector<Vec3> extra_walls_ENU;
  for (const Vec3& wall : extra_walls_W) extra_walls_ENU.push_back(turnedClockwise(wall, map.north.turn_rad));
  survey(options, extra_walls_ENU, diagnostics, &map);
  map.notes = describe(map, run);
  map.notes.insert(map.notes.end(), options.notes.begin(), options.notes.end());
  return map;
}

}  // namespace lodeline

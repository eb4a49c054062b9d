#include "lodeline/output/survey/map/dive_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/io/tables/cells.h"
#include "lodeline/io/tables/text_lines.h"
#include "lodeline/output/survey/map/map_times.h"
#include "lodeline/output/survey/map/survey_name.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

/// Date of a stamp, if known.
std::string dayOf(Time time) { return isoTime(time).value_or("").substr(0, 10); }

std::string dateOf(const RunFolder& run, const DiveMapOptions& options) {
  if (!options.date.empty()) {
    decimalYear(options.date);  // throws for an invalid date
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

void expectFinite(double value, const char* option) {
  if (!std::isfinite(value)) throw UsageError(fmt::format("{} {}: a number is wanted", option, value));
}

void checkNumbers(const DiveMapOptions& options) {
  expectFinite(options.start_depth_m.value_or(0.0), "--start-depth");
  expectFinite(options.geoid_height_m.value_or(0.0), "--geoid-height");
  expectFinite(options.turn_deg.value_or(0.0), "--turn");
  expectFinite(options.stations.spacing_m, "--spacing");
  expectFinite(options.relative_sigma.value_or(0.0), "--relative-sigma");
  for (double sigma_m : {options.entrance_sigma_m, options.entrance_height_sigma_m}) {
    if (std::isfinite(sigma_m) && sigma_m >= 0.0) continue;
    throw UsageError(fmt::format("--entrance-sigma {}: metres of zero or more are wanted", sigma_m));
  }
}

/// Sets the depth of the first pose: as stated, else from the run's pressure sensor, else zero.
void setStartDepth(const RunFolder& run, const DiveMapOptions& options, Diagnostics* diagnostics,
                   DiveMap* map) {
  if (options.start_depth_m) {
    map->start_depth_m = *options.start_depth_m;
    map->start_depth_source = options.start_depth_source;
  } else if (run.depth_at_origin_m) {
    map->start_depth_m = *run.depth_at_origin_m;
    map->start_depth_source = "by the run's own pressure sensor";
  } else {
    map->start_depth_source = "assumed, since nothing states it";
    if (!options.entrance && !run.site) return;
    diagnostics->report(Severity::Notice, "start_depth_assumed",
                        "nothing states how deep the first pose was: 0 m are assumed, and all heights count "
                        "from that; --start-depth M states it");
  }
}

/// Great-circle distance on a sphere, m.
double roughDistance_m(const GeodeticPosition& a, const GeodeticPosition& b) {
  constexpr double kRadius_m = 6371e3;
  const auto direction = [](const GeodeticPosition& p) {
    const double latitude = p.latitude_deg * kDegree, longitude = p.longitude_deg * kDegree;
    return Vec3(std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
                std::sin(latitude));
  };
  return kRadius_m * std::atan2(direction(a).cross(direction(b)).norm(), direction(a).dot(direction(b)));
}

/// Throws UsageError where the entrance is not a valid position, or far from the one for which the run
/// computed its magnetic field.
void checkEntrance(const GeodeticPosition& entrance, const std::optional<GeodeticPosition>& site) {
  constexpr double kFarthest_m = 50e3;
  const GeodeticPosition swapped{entrance.longitude_deg, entrance.latitude_deg, entrance.height_m};
  const std::string text = fmt::format("--entrance: latitude {:g}, longitude {:g}, height {:g}",
                                       entrance.latitude_deg, entrance.longitude_deg, entrance.height_m);
  if (!std::isfinite(entrance.height_m)) throw UsageError(text + ": the height in m is wanted as a number");
  if (!(std::abs(entrance.latitude_deg) <= 90.0 && std::abs(entrance.longitude_deg) <= 360.0)) {
    const bool is_swapped = std::abs(entrance.longitude_deg) <= 90.0;
    throw UsageError(fmt::format("{} is no place; LAT,LON,HEIGHT is wanted, in degrees and m{}", text,
                                 is_swapped ? ": latitude and longitude seem to be swapped" : ""));
  }
  if (!site || roughDistance_m(entrance, *site) < kFarthest_m) return;
  throw UsageError(fmt::format(
      "{} lies {:.0f} km from the --site {:g},{:g} of the run, whose magnetic field gave it north{}", text,
      1e-3 * roughDistance_m(entrance, *site), site->latitude_deg, site->longitude_deg,
      roughDistance_m(swapped, *site) < kFarthest_m ? ": latitude and longitude seem to be swapped"
                                                    : "; correct one of them"));
}

/// Text for headers: valid UTF-8 in one line, because further lines would be read as data.
std::string headerText(const std::string& text) {
  std::string line = isUtf8(text) ? text : fromLatin1(text);
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return c < ' ' || c == 0x7F; }, ' ');
  return line;
}

std::optional<Georeference> placeOf(const std::optional<GeodeticPosition>& entrance, const std::string& crs,
                                    double start_depth_m) {
  if (!entrance) return std::nullopt;
  GeodeticPosition first = *entrance;
  first.longitude_deg = std::remainder(first.longitude_deg, 360.0);
  first.height_m -= start_depth_m;
  return Georeference(first, MapGrid(crs, first));
}

void reportGrid(const MapGridDescription& grid, Diagnostics* diagnostics) {
  constexpr double kCoarse_m = 5.0;
  if (grid.is_outside_area) {
    diagnostics->report(Severity::Warning, "grid_outside_area",
                        fmt::format("the entrance lies outside of the area of {} ({}): {}", grid.name,
                                    grid.title, grid.area));
  }
  if (grid.lacks_grid_file || grid.accuracy_m.value_or(HUGE_VAL) > kCoarse_m) {
    diagnostics->report(
        Severity::Warning, "grid_accuracy",
        fmt::format("coordinates in {} come by '{}', accurate to {}{}", grid.title, grid.operation,
                    grid.accuracy_m ? fmt::format("{:g} m", *grid.accuracy_m) : "nobody knows what",
                    grid.lacks_grid_file
                        ? "; a better way takes a grid file that PROJ lacks here: see `projsync`"
                        : ""));
  }
}

/// Sets the level that heights count from, and its height above the ellipsoid.
void setHeights(const DiveMapOptions& options, Diagnostics* diagnostics, DiveMap* map) {
  map->heights = verticalDatum(options.vertical_datum, map->place->origin());
  if (options.geoid_height_m) map->heights.geoid_height_m = options.geoid_height_m;
  map->geoid_height_m = map->heights.geoid_height_m.value_or(0.0);
  if (map->heights.name.empty() || map->heights.geoid_height_m) return;
  diagnostics->report(
      Severity::Notice, "geoid_height_unknown",
      fmt::format("PROJ lacks the file of the geoid of {}: heights in GeoJSON count from it and not "
                  "from the ellipsoid; --geoid-height M states the difference",
                  map->heights.name));
}

/// Sigmas of the last pose whose variances are all positive. A run without a covariance writes zeros or
/// negative numbers, which do not mean certainty.
std::optional<Vec3> lastSigma(const std::vector<PositionUncertainty>& uncertainties,
                              Diagnostics* diagnostics) {
  for (auto last = uncertainties.rbegin(); last != uncertainties.rend(); ++last) {
    const Vec3 variances = last->covariance.diagonal();
    if (variances.minCoeff() <= 0.0) continue;
    if (last != uncertainties.rbegin()) {
      diagnostics->report(
          Severity::Warning, "sigma_not_positive",
          fmt::format("variances of the last {} poses are zero or negative, which says nothing of "
                      "how well they are known: those at {:.3f} s are taken for the end",
                      last - uncertainties.rbegin(), last->time.seconds()));
    }
    return variances.cwiseSqrt();
  }
  if (!uncertainties.empty()) {
    diagnostics->report(Severity::Warning, "sigma_not_positive",
                        "no pose has positive variances: the run does not say how well positions are known");
  }
  return std::nullopt;
}

/// One sigma of the last pose's position relative to the first.
Vec3 endSigma(const DiveMap& map, const DiveMapOptions& options, Diagnostics* diagnostics) {
  constexpr double kAssumedShare = 0.01;
  const double length_m = map.survey.length_m();
  if (options.relative_sigma) return Vec3::Constant(*options.relative_sigma * length_m);
  if (const std::optional<Vec3> sigma = lastSigma(map.uncertainties, diagnostics)) return *sigma;
  diagnostics->report(Severity::Warning, "sigma_assumed",
                      "the run says nothing of its uncertainty: 1 % of the length is assumed for the end; "
                      "--relative-sigma states another");
  return Vec3::Constant(kAssumedShare * length_m);
}

void survey(const DiveMapOptions& options, Diagnostics* diagnostics, DiveMap* map) {
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
  std::vector<Vec3> walls = map->echoes_ENU;
  for (const MapLandmark& landmark : map->landmarks) {
    if (landmark.observations >= options.min_observations) walls.push_back(landmark.position);
  }
  measurePassage(walls, options.passage, &map->survey);
}

}  // namespace

DiveMap makeDiveMap(const RunFolder& run, const DiveMapOptions& options,
                    const std::vector<Vec3>& extra_walls_W, Diagnostics* diagnostics) {
  DiveMap map;
  checkNumbers(options);
  map.name = options.name.empty() ? surveyNames({run.folder}).front() : surveyName(options.name);
  if (!options.name.empty() && map.name != options.name) {
    diagnostics->report(
        Severity::Notice, "name_changed",
        fmt::format("--name {}: the survey and its files are named '{}'; survey programs take "
                    "letters, digits, '_' and '-'",
                    options.name, map.name));
  }
  map.title = options.title.empty() ? map.name : options.title;
  map.team = options.team;
  map.date = dateOf(run, options);
  const std::optional<GeodeticPosition> entrance = options.entrance ? options.entrance : run.site;
  if (entrance) checkEntrance(*entrance, run.site);
  setStartDepth(run, options, diagnostics, &map);
  map.place = placeOf(entrance, options.crs, map.start_depth_m);
  if (map.place) reportGrid(map.place->gridDescription(), diagnostics);
  map.north = findNorth(run.heading_reference, entrance, map.date, options.turn_deg);
  // Survey programs refuse a standard deviation of zero.
  map.place_sigma = Vec3(options.entrance_sigma_m, options.entrance_sigma_m, options.entrance_height_sigma_m)
                        .cwiseMax(1e-3);
  map.run_folder = std::filesystem::absolute(run.folder).lexically_normal();
  if (map.place) setHeights(options, diagnostics, &map);
  turn(run, &map);
  for (const Vec3& wall : extra_walls_W) map.echoes_ENU.push_back(turnedClockwise(wall, map.north.turn_rad));
  survey(options, diagnostics, &map);
  map.notes = describe(map, run);
  map.notes.insert(map.notes.end(), options.notes.begin(), options.notes.end());
  map.title = headerText(map.title);
  for (std::string& name : map.team) name = headerText(name);
  std::erase_if(map.team, [](const std::string& name) { return trimmed(name).empty(); });
  for (std::string& note : map.notes) note = headerText(note);
  return map;
}

}  // namespace lodeline

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "apps/lodeline/map/map_subcommands.h"
#include "apps/lodeline/shared/place_argument.h"
#include "lodeline/diagnostics.h"
#include "lodeline/mapping/control/files/control_set.h"
#include "lodeline/mapping/store/map_change.h"
#include "lodeline/mapping/store/map_file.h"
#include "lodeline/output/report/findings.h"

namespace lodeline {
namespace {

struct ControlArguments {
  std::string map, file;
  std::vector<std::string> site;
  std::vector<double> grid_origin;
};

/// The keyframe of a dive nearest in time to a visit. Throws InputError where none is near.
KeyframeId keyframeOf(const MapFile& map, const ControlVisit& visit) {
  constexpr double kFarthest_s = 10.0;
  std::vector<MapDive> dives = map.dives();
  std::erase_if(dives, [&](const MapDive& dive) { return !visit.dive.empty() && dive.name != visit.dive; });
  if (dives.empty()) throw InputError(fmt::format("{}: the map has no dive '{}'", visit.origin, visit.dive));
  std::optional<KeyframeId> nearest;
  double nearest_s = kFarthest_s;
  for (const MapDive& dive : dives) {
    std::optional<Time> first;
    map.forEachKeyframe(dive.id, [&](const StoredKeyframe& row) {
      if (!first) first = row.keyframe.time;
      const Time wanted = visit.stamp ? *visit.stamp : *first + visit.since_start.value_or(Duration());
      const double apart_s = std::abs((row.keyframe.time - wanted).seconds());
      if (apart_s >= nearest_s) return;
      nearest_s = apart_s;
      nearest = row.keyframe.id;
    });
  }
  if (!nearest) {
    throw InputError(
        fmt::format("{}: no keyframe of the map is within {:.0f} s of this time", visit.origin, kFarthest_s));
  }
  return *nearest;
}

void addControl(const ControlArguments& arguments) {
  MapFile map = MapFile::open(arguments.map, MapFile::Access::Change);
  ControlReadOptions options;
  options.site = map.description().site;
  if (!arguments.site.empty()) options.site = placeFromWords(arguments.site, "--site");
  if (!arguments.grid_origin.empty())
    options.grid_origin = Vec3(arguments.grid_origin[0], arguments.grid_origin[1], arguments.grid_origin[2]);
  Diagnostics diagnostics;
  const ControlSet control = readControl(arguments.file, options, &diagnostics);
  // The rig was beside the mark, not on it.
  constexpr double kReach_m = 0.5;
  MapChange change = map.change();
  std::map<std::string, int64_t> ids;
  for (const ControlPoint& point : control.points) ids[point.name] = change.putControlPoint(point);
  for (const ControlVisit& visit : control.visits) {
    ControlObservation seen;
    seen.point = ids.at(visit.point);
    seen.keyframe = keyframeOf(map, visit);
    seen.in_body.covariance = kReach_m * kReach_m * Mat3::Identity();
    change.addControlObservation(seen);
  }
  change.commit();
  fmt::print("{} control points and {} visits added; `lodeline map solve {}` uses them\n{}",
             control.points.size(), control.visits.size(), arguments.map, findingsText(diagnostics));
}

}  // namespace

void addMapControlCommand(CLI::App* map) {
  const auto arguments = std::make_shared<ControlArguments>();
  CLI::App* command = map->add_subcommand(
      "control", "Add control points: fixes, surveyed stations and marks, from a CSV or Survex file");
  command->add_option("MAP", arguments->map, "file of the map")->required();
  command->add_option("FILE", arguments->file, "table (.csv), or Survex' .3d or .pos")->required();
  command
      ->add_option("--site", arguments->site,
                   "LAT,LON,HEIGHT (degrees, m) of the map's origin, for positions in degrees")
      ->delimiter(',')
      ->expected(1, 3);
  command
      ->add_option("--grid-origin", arguments->grid_origin,
                   "EASTING,NORTHING,ALTITUDE (m) of the map's origin, for positions on a grid")
      ->delimiter(',')
      ->expected(3);
  command->callback([arguments] { addControl(*arguments); });
}

}  // namespace lodeline

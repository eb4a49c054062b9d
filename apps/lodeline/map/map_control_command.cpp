#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "apps/lodeline/map/map_subcommands.h"
#include "apps/lodeline/shared/place_argument.h"
#include "lodeline/diagnostics.h"
#include "lodeline/mapping/control/control_factor.h"
#include "lodeline/mapping/store/map_change.h"
#include "lodeline/mapping/store/map_file.h"
#include "lodeline/output/report/findings.h"

namespace lodeline {
namespace {

struct ControlArguments {
  std::string map, file;
  std::string site;
  std::vector<double> grid_origin;
};

/// A dive with its keyframes in order of time.
struct VisitedDive {
  std::string name;
  std::vector<VisitedKeyframe> keyframes;

  /// Whether a stamp is within the dive, or just outside.
  bool contains(Time stamp) const {
    constexpr double kAround_s = 2.0;
    return !keyframes.empty() && (stamp - keyframes.front().time).seconds() > -kAround_s &&
           (keyframes.back().time - stamp).seconds() > -kAround_s;
  }
};

std::vector<VisitedDive> visitedDives(const MapFile& map) {
  std::vector<VisitedDive> dives;
  for (const MapDive& dive : map.dives()) {
    dives.push_back({dive.name, {}});
    map.forEachKeyframe(dive.id, [&](const StoredKeyframe& row) {
      dives.back().keyframes.push_back({row.keyframe.id, row.keyframe.time, row.keyframe.odom_from_body});
    });
  }
  return dives;
}

/// Names the dive of each visit that does not: the dive around its stamp, or the only one.
void nameDives(const std::vector<VisitedDive>& dives, std::vector<ControlVisit>* visits) {
  for (ControlVisit& visit : *visits) {
    std::vector<std::string> names;
    for (const VisitedDive& dive : dives) {
      const bool fits =
          visit.dive.empty() ? !visit.stamp || dive.contains(*visit.stamp) : dive.name == visit.dive;
      if (fits) names.push_back(dive.name);
    }
    if (names.size() != 1) {
      throw InputError(fmt::format("{}: {} of the map fits the visit of '{}'; name it in the column 'dive'",
                                   visit.origin, names.empty() ? "no dive" : "more than one dive",
                                   visit.point));
    }
    visit.dive = names.front();
  }
}

void addControlFile(const ControlArguments& arguments) {
  MapFile map = MapFile::open(arguments.map, MapFile::Access::Change);
  Diagnostics diagnostics;
  ControlReadOptions options;
  options.site = map.description().site;
  if (!arguments.site.empty()) options.site = placeFromText(arguments.site, "--site", &diagnostics);
  if (!arguments.grid_origin.empty())
    options.grid_origin = Vec3(arguments.grid_origin[0], arguments.grid_origin[1], arguments.grid_origin[2]);
  ControlSet control = readControl(arguments.file, options, &diagnostics);
  const std::vector<VisitedDive> dives = visitedDives(map);
  nameDives(dives, &control.visits);
  std::vector<ControlFactor> factors;
  for (const VisitedDive& dive : dives) {
    if (dive.keyframes.empty()) continue;
    // A time since the start counts from the first keyframe.
    const std::vector<ControlFactor> of_dive =
        factorsOfVisits(control, dive.name, dive.keyframes.front().time, dive.keyframes);
    factors.insert(factors.end(), of_dive.begin(), of_dive.end());
  }
  MapChange change = map.change();
  addControl(control, factors, &change);
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
  command->add_option(
      "--site", arguments->site,
      "LAT,LON,HEIGHT of the map's origin, as --entrance of `export`, for positions in degrees");
  command
      ->add_option("--grid-origin", arguments->grid_origin,
                   "EASTING,NORTHING,ALTITUDE (m) of the map's origin, for positions on a grid")
      ->delimiter(',')
      ->expected(3);
  command->callback([arguments] { addControlFile(*arguments); });
}

}  // namespace lodeline

#include <CLI/CLI.hpp>
#include <memory>

#include "apps/lodeline/export/export_command.h"
#include "apps/lodeline/map/map_subcommands.h"
#include "lodeline/diagnostics.h"
#include "lodeline/mapping/session/map_points.h"
#include "lodeline/mapping/store/map_file.h"
#include "lodeline/version.h"

namespace lodeline {
namespace {

struct MapExportArguments {
  std::string map;
  ExportArguments files;
};

/// A dive of the map as a run whose world is the map: poses and covariances of the common solution.
RunFolder runOfDive(const MapFile& map, const MapDive& dive, std::optional<double> depth_at_origin_m) {
  RunFolder run;
  run.folder = dive.name;
  run.trajectory_file = map.path().filename().string();
  run.program = std::string("lodeline ") + LODELINE_VERSION;
  run.recording = dive.recording;
  run.heading_reference = dive.heading_reference;
  run.depth_at_origin_m = depth_at_origin_m;
  map.forEachKeyframe(dive.id, [&](const StoredKeyframe& row) {
    if (!row.solved) return;
    run.trajectory.poses.push_back({row.keyframe.time, row.solved->map_from_body});
    run.uncertainties.push_back({row.keyframe.time, row.solved->covariance.topLeftCorner<3, 3>()});
  });
  run.landmarks = mapPointsOf(map, dive.id);
  return run;
}

/// Depth of the origin of the map by the first keyframe that knows its depth.
std::optional<double> depthAtOrigin(const MapFile& map) {
  std::optional<double> depth_m;
  for (const MapDive& dive : map.dives()) {
    map.forEachKeyframe(dive.id, [&](const StoredKeyframe& row) {
      if (!depth_m && row.solved && row.keyframe.depth_m)
        depth_m = row.keyframe.depth_m->value + row.solved->map_from_body.translation.z();
    });
  }
  return depth_m;
}

void exportMap(MapExportArguments arguments) {
  const MapFile map = MapFile::open(arguments.map, MapFile::Access::Read);
  std::vector<RunFolder> runs;
  const std::optional<double> depth_m = depthAtOrigin(map);
  for (const MapDive& dive : map.dives()) {
    runs.push_back(runOfDive(map, dive, depth_m));
    if (runs.back().trajectory.poses.size() < 2)
      throw InputError(arguments.map + ": dive '" + dive.name +
                       "' has no solved poses; run `lodeline map solve`");
    arguments.files.runs.push_back(dive.name);
  }
  if (runs.empty()) throw InputError(arguments.map + ": the map has no dive");
  arguments.files.map.min_observations = 1;  // a keyframe's point has been seen in many images
  Diagnostics diagnostics;
  exportDives(arguments.files, std::move(runs), &diagnostics);
}

}  // namespace

void addMapExportCommand(CLI::App* map) {
  const auto arguments = std::make_shared<MapExportArguments>();
  CLI::App* command =
      map->add_subcommand("export", "All dives of a map as one survey: Survex, Therion, GIS, 3-D");
  command->add_option("MAP", arguments->map, "file of the map")->required();
  command->add_option("-o,--output", arguments->files.output, "folder for the files")->required();
  addMapFileOptions(command, &arguments->files);
  command->callback([arguments] { exportMap(*arguments); });
}

}  // namespace lodeline

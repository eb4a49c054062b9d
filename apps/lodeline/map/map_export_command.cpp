#include <CLI/CLI.hpp>
#include <memory>

#include "apps/lodeline/export/export_command.h"
#include "apps/lodeline/map/map_dives.h"
#include "apps/lodeline/map/map_subcommands.h"
#include "lodeline/diagnostics.h"
#include "lodeline/mapping/store/map_file.h"

namespace lodeline {
namespace {

struct MapExportArguments {
  std::string map;
  ExportArguments files;
};

void exportMap(MapExportArguments arguments) {
  const MapFile map = MapFile::open(arguments.map, MapFile::Access::Read);
  std::vector<RunFolder> runs = runsOfMap(map);
  for (const RunFolder& run : runs) arguments.files.runs.push_back(run.folder.string());
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

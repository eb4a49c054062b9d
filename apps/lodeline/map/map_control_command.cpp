#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "apps/lodeline/map/map_dives.h"
#include "apps/lodeline/map/map_subcommands.h"
#include "apps/lodeline/shared/common_options.h"
#include "apps/lodeline/shared/place_argument.h"
#include "lodeline/diagnostics.h"
#include "lodeline/mapping/store/map_file.h"

namespace lodeline {
namespace {

struct ControlArguments {
  std::string map, file;
  std::string site;
  std::vector<double> grid_origin;
  Verbosity verbosity;
};

void addControl(const ControlArguments& arguments) {
  MapFile map = MapFile::open(arguments.map, MapFile::Access::Change);
  Diagnostics diagnostics;
  ControlReadOptions options;
  options.site = map.description().site;
  if (!arguments.site.empty()) options.site = placeFromText(arguments.site, "--site", &diagnostics);
  if (!arguments.grid_origin.empty())
    options.grid_origin = Vec3(arguments.grid_origin[0], arguments.grid_origin[1], arguments.grid_origin[2]);
  const ControlSet control = addControlFile(&map, arguments.file, options, &diagnostics);
  if (!arguments.verbosity.quiet) {
    fmt::print("{} control points and {} visits added; `lodeline map solve {}` uses them\n",
               control.points.size(), control.visits.size(), arguments.map);
  }
  printFindings(diagnostics, arguments.verbosity);
}

}  // namespace

void addMapControlCommand(CLI::App* map) {
  const auto arguments = std::make_shared<ControlArguments>();
  CLI::App* command = map->add_subcommand(
      "control", "Add control points: fixes, surveyed stations and marks, from a CSV or Survex file");
  command->add_option("MAP", arguments->map, "file of the map")->required();
  command->add_option("FILE", arguments->file, "table (.csv), or Survex' .3d or .pos")->required();
  command->add_option("--site", arguments->site,
                      "place of the origin of the map, as --entrance of `export`, for positions in degrees");
  command
      ->add_option("--grid-origin", arguments->grid_origin,
                   "origin of the map on a grid, for positions on that grid: EASTING,NORTHING,ALTITUDE (m)")
      ->delimiter(',')
      ->expected(3);
  addVerbosity(&arguments->verbosity, command);
  command->callback([arguments] { addControl(*arguments); });
}

}  // namespace lodeline

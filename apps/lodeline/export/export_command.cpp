#include "apps/lodeline/export/export_command.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "apps/lodeline/export/export_dives.h"
#include "apps/lodeline/shared/bag_options.h"
#include "apps/lodeline/shared/common_options.h"

namespace lodeline {
namespace {

void addPlaceOptions(CLI::App* command, ExportArguments* arguments) {
  command->add_option("--entrance", arguments->entrance,
                      "place of the water's surface above the first pose: LAT,LON,HEIGHT (degrees, m), \"16Q "
                      "450000 2246000 5\" (UTM) or \"EPSG:6372 3912345 912345 5\"; without it, the --site of "
                      "the run, else files are in plain metres");
  command
      ->add_option("--entrance-sigma", arguments->entrance_sigma,
                   "one sigma of that place: HORIZONTAL,VERTICAL (m)")
      ->delimiter(',')
      ->expected(2)
      ->capture_default_str();
  command->add_option("--start-depth", arguments->map.start_depth_m,
                      "depth of the first pose below that surface, m; without it, that of the depth profile, "
                      "else of the pressure sensor, else 0");
  command->add_option(
      "--geoid-height", arguments->map.geoid_height_m,
      "height of the vertical datum above the WGS 84 ellipsoid, m; without it, PROJ's, else 0");
  command->add_option("--vertical-datum", arguments->map.vertical_datum,
                      "level that HEIGHT counts from: EPSG:5703 (NAVD88), EPSG:5773 (EGM96), ellipsoid");
  command
      ->add_option("--crs", arguments->map.crs,
                   "grid: a UTM zone (UTM17N), a national or polar grid (EPSG:6372), or auto: the UTM zone "
                   "of the entrance, UPS near a pole")
      ->capture_default_str();
  command->add_option("--date", arguments->map.date,
                      "date of the dive, YYYY-MM-DD; without it, that of the run or of its stamps");
  command->add_option(
      "--turn", arguments->map.turn_deg,
      "clockwise turn of the run's world to true north, degrees, in place of the declination");
}

void addSurveyOptions(CLI::App* command, ExportArguments* arguments) {
  DiveMapOptions& map = arguments->map;
  command->add_option("--name", map.name, "name of survey and files; without it, that of the run's folder");
  command->add_option("--title", map.title, "title of the survey");
  command->add_option("--team", map.team, "name of a person of the team; may be repeated");
  command->add_option("--spacing", map.stations.spacing_m, "distance between stations on a straight way, m")
      ->check(CLI::Range(0.5, 1000.0))
      ->capture_default_str();
  command
      ->add_option("--relative-sigma", map.relative_sigma,
                   "uncertainty of the end over the length of the line; without it, that of the run")
      ->check(CLI::Range(1e-6, 1.0));
  command->add_flag("--closed", map.is_closed,
                    "the dive ended exactly where it began; the survey program spreads the misclosure");
  command->add_flag("--no-splays", arguments->no_splays, "write no legs to the walls");
  command->add_option("--recording", arguments->recording,
                      "recording of the run, for walls by its sonar, and for COLMAP's cameras and images");
  addBagOptions(&arguments->bag, command);
}

}  // namespace

void addMapFileOptions(CLI::App* command, ExportArguments* arguments) {
  command
      ->add_option(
          "-f,--format", arguments->formats,
          "survex, therion, geojson, kml, gpx, gpkg, dxf, ply, csv, tum, colmap; several with commas")
      ->delimiter(',');
  addOverwrite(&arguments->overwrite, command);
  addVerbosity(&arguments->verbosity, command);
  addPlaceOptions(command, arguments);
  addSurveyOptions(command, arguments);
}

void addExportCommand(CLI::App& program) {
  const auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = program.add_subcommand(
      "export", "A run as files for surveyors and map makers: Survex, Therion, GIS, 3-D, Foxglove");
  command->add_option("RUN", arguments->runs, "folders that `lodeline run` wrote; several make one project")
      ->required();
  command->add_option("-o,--output", arguments->output, "folder for the files; without it, RUN/export");
  addMapFileOptions(command, arguments.get());
  addDepthOptions(command, &arguments->depth);
  addFoxgloveOptions(command, &arguments->foxglove);
  command->footer(
      "Every file begins with where it is from, which north it uses and what was applied.\n"
      "Examples:\n"
      "  lodeline export out --format survex,therion,kml --entrance 29.83,-82.60,10 --date 2026-11-21\n"
      "  lodeline export out --format csv,ply -o map\n"
      "  lodeline export out --format mcap --images\n"
      "  lodeline export dive1 dive2 --format therion --name cave -o map --entrance 29.83,-82.60,10\n"
      "  lodeline export out --format survex --depth-profile computer.csv --correct-depth");
  command->callback([arguments] { exportRuns(*arguments); });
}

}  // namespace lodeline

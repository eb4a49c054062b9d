#include "apps/lodeline/export/export_command.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "apps/lodeline/export/export_dives.h"
#include "apps/lodeline/shared/bag_options.h"
#include "apps/lodeline/shared/common_options.h"

namespace lodeline {
namespace {

void addPlaceOptions(CLI::App* command, ExportArguments* arguments) {
  command->add_option(
      "--entrance", arguments->entrance,
      "of the water's surface above the first pose: LAT,LON,HEIGHT in degrees (WGS 84, any notation) and "
      "m; \"16Q 450000 2246000 5\" (UTM) or \"EPSG:6372 3912345 912345 5\"; without it, the run's own "
      "--site, else a map in metres");
  command
      ->add_option("--entrance-sigma", arguments->entrance_sigma,
                   "HORIZONTAL,VERTICAL (m): how well that is known")
      ->delimiter(',')
      ->expected(2)
      ->capture_default_str();
  command->add_option(
      "--start-depth", arguments->map.start_depth_m,
      "m of the first pose under that surface; without it, the depth profile's, else that of the "
      "run's pressure sensor, else 0");
  command->add_option(
      "--geoid-height", arguments->map.geoid_height_m,
      "m of the level that HEIGHT counts from above the WGS 84 ellipsoid, for GeoJSON; without "
      "it, PROJ's for --vertical-datum, else 0");
  command->add_option("--vertical-datum", arguments->map.vertical_datum,
                      "the level that HEIGHT counts from: EPSG:5703 (NAVD88), EPSG:5773 (EGM96), ellipsoid");
  command
      ->add_option("--crs", arguments->map.crs,
                   "grid: a UTM zone (UTM17N), a national or polar grid (EPSG:6372); auto: the entrance's "
                   "UTM zone, or "
                   "UPS near a pole")
      ->capture_default_str();
  command->add_option("--date", arguments->map.date, "YYYY-MM-DD; without it, the run's or its stamps'");
  command->add_option(
      "--turn", arguments->map.turn_deg,
      "degrees clockwise that turn the run's world to true north, in place of the declination");
}

void addSurveyOptions(CLI::App* command, ExportArguments* arguments) {
  DiveMapOptions& map = arguments->map;
  command->add_option("--name", map.name,
                      "of survey and files; without it, the run folder's; with several runs, of the project");
  command->add_option("--title", map.title, "of the survey");
  command->add_option("--team", map.team, "a person; once for each");
  command->add_option("--spacing", map.stations.spacing_m, "m between stations on a straight way")
      ->check(CLI::Range(0.5, 1000.0))
      ->capture_default_str();
  command
      ->add_option("--relative-sigma", map.relative_sigma,
                   "uncertainty of the end by the length of the line, as 0.01; without it, the run's own")
      ->check(CLI::Range(1e-6, 1.0));
  command->add_flag(
      "--closed", map.is_closed,
      "the dive ended exactly where it began: equate both and let the program spread the misclosure");
  command->add_flag("--no-splays", arguments->no_splays, "leave the legs to the walls out");
  command->add_option(
      "--recording", arguments->recording,
      "the run's recording, a folder or a ROS bag: its sonar adds walls; COLMAP takes cameras "
      "and images from it");
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

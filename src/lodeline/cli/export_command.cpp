#include "lodeline/cli/export_command.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>

#include "lodeline/base/error.h"
#include "lodeline/base/output_file.h"
#include "lodeline/cli/export_depth.h"
#include "lodeline/cli/open_recording.h"
#include "lodeline/export/map_files.h"
#include "lodeline/export/recording_images.h"
#include "lodeline/export/recording_walls.h"
#include "lodeline/report/findings.h"

namespace lodeline {
namespace {

struct ExportArguments {
  std::string run;
  std::vector<std::string> formats;
  std::string output;
  std::string recording;
  BagArguments bag;
  std::vector<double> entrance;
  std::vector<double> entrance_sigma = {3.0, 5.0};
  bool no_splays = false;
  std::optional<double> start_depth_m;
  DepthProfileArguments depth;
  DiveMapOptions map;
};

/// What the recording adds to the run.
struct RecordingParts {
  std::optional<MapImages> images;
  std::vector<Vec3> walls_W;
};

RecordingParts readRecording(const ExportArguments& arguments, const std::vector<MapFormat>& formats,
                             const RunFolder& run, Diagnostics* diagnostics) {
  RecordingParts parts;
  if (arguments.recording.empty()) return parts;
  EurocOptions options;
  options.with_cameras = std::find(formats.begin(), formats.end(), MapFormat::Colmap) != formats.end();
  const std::unique_ptr<RecordedSource> source =
      openRecording(arguments.recording, options, arguments.bag, diagnostics);
  parts.walls_W = sonarWalls(*source, run.trajectory, diagnostics);
  if (options.with_cameras) parts.images = recordingImages(*source, run, diagnostics);
  return parts;
}

DiveMapOptions mapOptions(const ExportArguments& arguments) {
  DiveMapOptions options = arguments.map;
  if (!arguments.entrance.empty()) {
    options.entrance = GeodeticPosition{arguments.entrance[0], arguments.entrance[1], arguments.entrance[2]};
  }
  options.entrance_sigma_m = arguments.entrance_sigma[0];
  options.entrance_height_sigma_m = arguments.entrance_sigma[1];
  options.start_depth_m = arguments.start_depth_m.value_or(0.0);
  if (arguments.no_splays) options.passage.splay_sectors = 0;
  return options;
}

void exportRun(const ExportArguments& arguments) {
  std::vector<MapFormat> formats;
  for (const std::string& name : arguments.formats) formats.push_back(mapFormatFromString(name));
  if (formats.empty() && arguments.depth.file.empty()) {
    throw UsageError("nothing to do: name formats with --format, or a --depth-profile to compare with");
  }
  Diagnostics diagnostics;
  RunFolder run = readRunFolder(arguments.run, &diagnostics);
  DiveMapOptions options = mapOptions(arguments);
  std::filesystem::path folder = arguments.output;
  if (folder.empty()) folder = std::filesystem::path(arguments.run) / "export";
  createOutputFolder(folder);
  if (!arguments.depth.file.empty()) {
    applyDepthProfile(arguments.depth, folder, arguments.start_depth_m.has_value(), &run, &options,
                      &diagnostics);
  }
  const RecordingParts parts = readRecording(arguments, formats, run, &diagnostics);
  const DiveMap map = makeDiveMap(run, options, parts.walls_W, &diagnostics);
  std::string files;
  for (MapFormat format : formats) {
    for (const std::filesystem::path& file : writeMap(map, parts.images, format, folder)) {
      files += "written: " + file.string() + "\n";
    }
  }
  for (const std::string& note : map.notes) fmt::print("{}\n", note);
  fmt::print("{}{}", files, findingsText(diagnostics));
}

void addPlaceOptions(CLI::App* command, ExportArguments* arguments) {
  command
      ->add_option(
          "--entrance", arguments->entrance,
          "LAT,LON,HEIGHT (WGS 84 degrees, m) of the water's surface above the first pose; without it, "
          "the run's own --site, else a map in metres")
      ->delimiter(',')
      ->expected(3);
  command
      ->add_option("--entrance-sigma", arguments->entrance_sigma,
                   "HORIZONTAL,VERTICAL (m): how well that is known")
      ->delimiter(',')
      ->expected(2)
      ->capture_default_str();
  command->add_option("--start-depth", arguments->start_depth_m,
                      "m of the first pose under that surface; without it, the depth profile's, else 0");
  command
      ->add_option("--geoid-height", arguments->map.geoid_height_m,
                   "m of the level that HEIGHT counts from above the WGS 84 ellipsoid; for GeoJSON")
      ->capture_default_str();
  command->add_option("--crs", arguments->map.crs, "UTM zone, as UTM17N or EPSG:32617; auto: the entrance's")
      ->capture_default_str();
  command->add_option("--date", arguments->map.date, "YYYY-MM-DD; without it, the run's or its stamps'");
  command->add_option(
      "--turn", arguments->map.turn_deg,
      "degrees clockwise that turn the run's world to true north, in place of the declination");
}

void addSurveyOptions(CLI::App* command, ExportArguments* arguments) {
  DiveMapOptions& map = arguments->map;
  command->add_option("--name", map.name, "of survey and files; without it, the run folder's");
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
      "the run's recording, a folder or a ROS 1 bag: its sonar adds walls; COLMAP takes cameras "
      "and images from it");
  addBagOptions(&arguments->bag, command);
}

}  // namespace

void addExportCommand(CLI::App& program) {
  const auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = program.add_subcommand(
      "export", "A run as files for surveyors and map makers: Survex, Therion, GIS, 3-D");
  command->add_option("RUN", arguments->run, "folder that `lodeline run` wrote")->required();
  command
      ->add_option("-f,--format", arguments->formats,
                   "survex, therion, geojson, kml, gpx, ply, csv, tum, colmap; several with commas")
      ->delimiter(',');
  command->add_option("-o,--output", arguments->output, "folder for the files; without it, RUN/export");
  addPlaceOptions(command, arguments.get());
  addSurveyOptions(command, arguments.get());
  addDepthOptions(command, &arguments->depth);
  command->footer(
      "Every file begins with where it is from, which north it uses and what was applied.\n"
      "Examples:\n"
      "  lodeline export out --format survex,therion,kml --entrance 29.83,-82.60,10 --date 2026-11-21\n"
      "  lodeline export out --format csv,ply -o map\n"
      "  lodeline export out --format survex --depth-profile computer.csv --correct-depth");
  command->callback([arguments] { exportRun(*arguments); });
}

}  // namespace lodeline

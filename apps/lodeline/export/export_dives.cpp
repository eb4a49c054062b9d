#include "apps/lodeline/export/export_dives.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <set>

#include "apps/lodeline/shared/place_argument.h"
#include "lodeline/diagnostics.h"
#include "lodeline/output/colmap/colmap_database.h"
#include "lodeline/output/survey/formats/map_files.h"
#include "lodeline/output/survey/formats/recording_images.h"
#include "lodeline/output/survey/formats/recording_walls.h"
#include "lodeline/output/survey/map/export_owner.h"
#include "lodeline/output/survey/map/survey_name.h"
#include "lodeline/output/walls/section/wall_sections.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {
namespace {

constexpr const char* kColmapDatabase = "colmap/database.db";

/// Additional data from the recording.
struct RecordingParts {
  std::optional<MapImages> images;
  std::vector<Vec3> walls_W;
};

/// One dive, ready for export.
struct ExportedDive {
  DiveMap map;
  RecordingParts recording;
  std::string depth_comparison;        ///< text of its table; empty without a depth profile
  std::vector<StationWalls> sections;  ///< by the sonar; empty where it saw no whole section
};

RecordingParts readRecording(const ExportArguments& arguments, const std::vector<MapFormat>& formats,
                             const RunFolder& run, const ShareDone& progress, Diagnostics* diagnostics) {
  RecordingParts parts;
  if (arguments.recording.empty()) return parts;
  EurocOptions options;
  options.with_cameras = std::find(formats.begin(), formats.end(), MapFormat::Colmap) != formats.end();
  const std::unique_ptr<RecordedSource> source =
      openRecording(arguments.recording, options, arguments.bag, diagnostics);
  parts.walls_W = sonarWalls(*source, run.trajectory, diagnostics, progress);
  if (options.with_cameras) parts.images = recordingImages(*source, run, diagnostics);
  return parts;
}

DiveMapOptions mapOptions(const ExportArguments& arguments, Diagnostics* diagnostics) {
  DiveMapOptions options = arguments.map;
  if (!arguments.entrance.empty())
    options.entrance = placeFromText(arguments.entrance, "--entrance", diagnostics);
  options.entrance_sigma_m = arguments.entrance_sigma[0];
  options.entrance_height_sigma_m = arguments.entrance_sigma[1];
  options.start_depth_source = "by --start-depth";
  if (arguments.no_splays) options.passage.splay_sectors = 0;
  return options;
}

std::vector<MapFormat> wantedFormats(const ExportArguments& arguments) {
  std::vector<MapFormat> formats;
  for (const std::string& name : arguments.formats) formats.push_back(mapFormatFromString(name));
  if (formats.empty() && arguments.depth.file.empty() && !arguments.foxglove.is_wanted) {
    throw UsageError("nothing to do: name formats with --format, or a --depth-profile to compare with");
  }
  const bool is_single = arguments.runs.size() == 1;
  if (!is_single && (!arguments.depth.file.empty() || !arguments.recording.empty())) {
    throw UsageError(
        "--depth-profile and --recording belong to one dive: export each RUN by itself with them");
  }
  if (!is_single && arguments.output.empty()) {
    throw UsageError("several runs want one folder for their files: name it with -o");
  }
  std::set<std::filesystem::path> folders;
  for (const std::string& run : arguments.runs) {
    if (folders.insert(std::filesystem::weakly_canonical(run)).second) continue;
    throw UsageError(fmt::format("{} is named twice: each RUN is one dive of the project", run));
  }
  return formats;
}

ExportedDive makeDive(const ExportArguments& arguments, const std::vector<MapFormat>& formats, RunFolder run,
                      DiveMapOptions options, const ShareDone& progress, Diagnostics* diagnostics) {
  ExportedDive dive;
  progress(0.0);
  if (!arguments.depth.file.empty())
    dive.depth_comparison = applyDepthProfile(arguments.depth, &run, &options, diagnostics);
  dive.recording = readRecording(arguments, formats, run, progress, diagnostics);
  dive.map = makeDiveMap(run, options, dive.recording.walls_W, diagnostics);
  if (dive.map.echoes_ENU.empty()) return dive;
  std::vector<StationWalls> sections = echoesAtStations(dive.map.echoes_ENU, dive.map.survey, {});
  takeSections(sections, options.passage.splay_sectors, &dive.map.survey);
  const bool has_whole = std::any_of(sections.begin(), sections.end(),
                                     [](const StationWalls& s) { return s.outline.area_m2.has_value(); });
  if (has_whole) dive.sections = std::move(sections);
  return dive;
}

/// Maps of all dives on the grid of the first one, because survey programs cannot join dives on different
/// grids.
std::vector<ExportedDive> makeDives(const ExportArguments& arguments, const std::vector<MapFormat>& formats,
                                    std::vector<RunFolder> runs, const ShareDone& progress,
                                    Diagnostics* diagnostics) {
  DiveMapOptions options = mapOptions(arguments, diagnostics);
  std::vector<ExportedDive> dives;
  if (runs.size() == 1) {
    dives.push_back(makeDive(arguments, formats, std::move(runs.front()), options, progress, diagnostics));
    return dives;
  }
  std::vector<std::filesystem::path> folders;
  for (const RunFolder& run : runs) folders.push_back(run.folder);
  const std::vector<std::string> names = surveyNames(folders);
  for (size_t i = 0; i < names.size(); ++i) {
    options.name = names[i];
    options.title.clear();
    const auto ofDive = [&](double share) {
      progress((static_cast<double>(i) + share) / static_cast<double>(names.size()));
    };
    dives.push_back(makeDive(arguments, formats, std::move(runs[i]), options, ofDive, diagnostics));
    const std::optional<Georeference>& place = dives.back().map.place;
    if (place) options.crs = place->gridDescription().code;
  }
  return dives;
}

std::filesystem::path outputFolder(const ExportArguments& arguments) {
  if (!arguments.output.empty()) return arguments.output;
  return std::filesystem::path(arguments.runs.front()) / "export";
}

/// Names of the files of the sections by the sonar: table, sheet, drawing.
std::array<std::string, 3> sectionFileNames(const DiveMap& map) {
  return {map.name + "_sections.csv", map.name + "_sections.svg", map.name + "_sections.dxf"};
}

void writeSections(const ExportedDive& dive, const std::filesystem::path& folder,
                   std::vector<std::filesystem::path>* files) {
  const auto [table, sheet, drawing] = sectionFileNames(dive.map);
  const auto write = [&](const std::string& name, const std::string& text) {
    files->push_back(folder / name);
    writeOutput(files->back(), text);
  };
  write(table, sectionsCsv(dive.map, dive.sections));
  write(sheet, sectionsSvg(dive.map, dive.sections));
  if (hasGdal()) write(drawing, sectionsDxf(dive.map, dive.sections));
}

std::string depthTableName(const DiveMap& map) { return map.name + "_depth_profile.csv"; }

void expectOwnFolder(const ExportArguments& arguments, const ExportedDive& dive,
                     const std::vector<MapFormat>& formats, const std::filesystem::path& folder) {
  std::vector<std::string> names = {depthTableName(dive.map)};
  for (const std::string& name : sectionFileNames(dive.map)) names.push_back(name);
  if (arguments.foxglove.is_wanted) names.push_back(foxgloveFileName(dive.map.name));
  for (MapFormat format : formats) {
    for (const std::string& name : mapFileNames(dive.map.name, format)) names.push_back(name);
    if (format == MapFormat::Colmap) names.push_back(kColmapDatabase);
  }
  expectOwnFiles(folder, dive.map, names);
}

void writeDive(const ExportedDive& dive, const std::vector<MapFormat>& formats,
               const std::filesystem::path& folder, const ShareDone& progress,
               std::vector<std::filesystem::path>* files, Diagnostics* diagnostics) {
  double done = 0.0;
  for (MapFormat format : formats) {
    progress(done++ / static_cast<double>(formats.size()));
    for (const auto& file : writeMap(dive.map, dive.recording.images, format, folder)) files->push_back(file);
    if (format != MapFormat::Colmap) continue;
    files->push_back(folder / kColmapDatabase);
    writeColmapDatabase(dive.map, dive.recording.images, files->back(), diagnostics);
  }
  createOutputFolder(folder);
  if (!dive.depth_comparison.empty()) {
    files->push_back(folder / depthTableName(dive.map));
    writeOutput(files->back(), dive.depth_comparison);
  }
  if (!dive.sections.empty()) writeSections(dive, folder, files);
  files->push_back(folder / notesFileName(dive.map.name));
  writeOutput(files->back(), notesText(dive.map));
}

/// Project name: as stated, else "cave"; different from the dives' names.
std::string projectName(const ExportArguments& arguments, const std::vector<DiveMap>& maps) {
  std::string name = surveyName(arguments.map.name.empty() ? "cave" : arguments.map.name);
  const auto isTaken = [&](const DiveMap& map) { return map.name == name; };
  while (std::any_of(maps.begin(), maps.end(), isTaken)) name += "_project";
  return name;
}

/// Writes the files that join several dives, for formats that support it.
void writeProjects(const ExportArguments& arguments, const std::vector<MapFormat>& formats,
                   const std::vector<ExportedDive>& dives, const std::filesystem::path& folder,
                   std::vector<std::filesystem::path>* files) {
  std::vector<DiveMap> maps;
  for (const ExportedDive& dive : dives) maps.push_back(dive.map);
  const std::string name = projectName(arguments, maps);
  const std::string title = arguments.map.title.empty() ? name : arguments.map.title;
  for (MapFormat format : formats) {
    if (!joinsDives(format)) continue;
    for (const auto& file : writeProject(maps, name, title, format, folder)) files->push_back(file);
  }
}

}  // namespace

void exportRuns(ExportArguments arguments) {
  takeFoxglove(&arguments.formats, &arguments.foxglove);
  wantedFormats(arguments);  // refuses wrong arguments before anything is read
  Diagnostics diagnostics;
  std::vector<RunFolder> runs;
  for (const std::string& folder : arguments.runs) runs.push_back(readRunFolder(folder, &diagnostics));
  exportDives(arguments, std::move(runs), &diagnostics);
}

void exportDives(const ExportArguments& arguments, std::vector<RunFolder> runs, Diagnostics* diagnostics) {
  const std::vector<MapFormat> formats = wantedFormats(arguments);
  Progress progress("maps", arguments.verbosity.quiet);
  const std::vector<ExportedDive> dives =
      makeDives(arguments, formats, std::move(runs), progress.function(), diagnostics);
  const std::filesystem::path folder = outputFolder(arguments);
  if (!arguments.overwrite) {
    for (const ExportedDive& dive : dives) expectOwnFolder(arguments, dive, formats, folder);
  }
  std::vector<std::filesystem::path> files;
  progress.begin("files");
  const auto count = static_cast<double>(dives.size());
  for (size_t i = 0; i < dives.size(); ++i) {
    const ExportedDive& dive = dives[i];
    const auto show = [&](double share) {
      progress.show((static_cast<double>(i) + share) / count, dive.map.name);
    };
    writeDive(dive, formats, folder, show, &files, diagnostics);
    if (!arguments.foxglove.is_wanted) continue;
    files.push_back(folder / foxgloveFileName(dive.map.name));
    writeFoxglove(arguments.foxglove, dive.map.run_folder, files.back(), diagnostics);
  }
  if (dives.size() > 1) writeProjects(arguments, formats, dives, folder, &files);
  progress.end();
  printFindings(*diagnostics, arguments.verbosity);
  if (arguments.verbosity.quiet) return;
  for (const ExportedDive& dive : dives) {
    if (dives.size() > 1) fmt::print("{}:\n", dive.map.name);
    for (const std::string& note : dive.map.notes) fmt::print("{}\n", note);
  }
  for (const std::filesystem::path& file : files) fmt::print("written: {}\n", file.string());
}

}  // namespace lodeline

#include "apps/lodeline/survey/survey_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <memory>

#include "apps/lodeline/map/map_dives.h"
#include "apps/lodeline/shared/common_options.h"
#include "apps/lodeline/shared/place_argument.h"
#include "apps/lodeline/survey/cave_of_map.h"
#include "lodeline/diagnostics.h"
#include "lodeline/mapping/session/map_merge.h"
#include "lodeline/mapping/session/map_solution.h"
#include "lodeline/output/survey/formats/write_formats.h"
#include "lodeline/output/survey/map/export_owner.h"
#include "lodeline/output/survey/map/survey_name.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

struct SurveyArguments {
  std::string project, output;
  bool overwrite = false;
  Verbosity verbosity;
  std::string name, title, entrance, crs, vertical_datum, date;
  std::vector<std::string> team;
  std::optional<double> merge_m, spacing_m;
};

bool isProject(const fs::path& file) { return file.extension() == ".yaml" || file.extension() == ".yml"; }

/// The project of the file, changed by the options of the command line.
SurveyProject projectOf(const SurveyArguments& arguments) {
  SurveyProject project;
  if (isProject(arguments.project)) {
    project = readSurveyProject(arguments.project);
  } else {
    project.map = arguments.project;
  }
  const auto take = [](const std::string& given, std::string* target) {
    if (!given.empty()) *target = given;
  };
  take(arguments.name, &project.name);
  take(arguments.title, &project.title);
  take(arguments.entrance, &project.entrance);
  take(arguments.crs, &project.crs);
  take(arguments.vertical_datum, &project.vertical_datum);
  take(arguments.date, &project.date);
  if (!arguments.team.empty()) project.team = arguments.team;
  project.merge_m = arguments.merge_m.value_or(project.merge_m);
  project.spacing_m = arguments.spacing_m.value_or(project.spacing_m);
  if (!(project.merge_m >= 0.0 && project.merge_m <= 50.0 && project.spacing_m >= 0.5))
    throw UsageError("merge: 0 to 50 m are wanted; spacing: 0.5 m or more");
  if (project.name.empty())
    project.name = isProject(arguments.project) ? fs::path(arguments.project).stem().string()
                                                : project.map.stem().string();
  project.name = surveyName(project.name);
  return project;
}

/// `progress`: takes the share of this run.
std::string addRun(const ProjectDive& dive, const ShareDone& progress, MapFile* map) {
  const fs::path file = fs::is_directory(dive.run) ? dive.run / "map.db" : dive.run;
  MapMergeOptions options;
  options.progress = progress;
  if (dive.start_ENU) {
    DiveStart& start = options.mapping.start.emplace();
    start.position = *dive.start_ENU;
    start.horizontal_sigma_m = dive.start_sigma_m.value_or(start.horizontal_sigma_m);
    start.vertical_sigma_m = dive.start_sigma_up_m.value_or(start.vertical_sigma_m);
    start.check();
  }
  const bool is_first = map->dives().empty();
  const MergedDive merged = mergeDive(map, MapFile::open(file, MapFile::Access::Read), options);
  return fmt::format("{}: {} keyframes, {} loops{}\n", merged.name, merged.summary.keyframes,
                     merged.summary.accepted,
                     is_first || merged.summary.is_placed ? "" : "; no place of the map was recognized");
}

void addProjectRuns(const SurveyProject& project, bool quiet, Progress& progress, MapFile* map) {
  progress.begin("joining dives");
  const auto count = static_cast<double>(project.dives.size());
  double done = 0.0;
  for (const ProjectDive& dive : project.dives) {
    const std::string added = addRun(
        dive, [&](double share) { progress.show((done + share) / count, dive.dive); }, map);
    ++done;
    if (quiet) continue;
    progress.end();
    fmt::print("{}", added);
  }
}

void reportSolution(const MapSolution& solution, Diagnostics* diagnostics) {
  for (const std::string& name : solution.unconnected) {
    diagnostics->report(Severity::Warning, "dive_not_joined",
                        name +
                            " shares no recognized place or control point with the first dive; its position "
                            "in the map means nothing");
  }
}

/// The common map of a project: its own, or a new one of its runs. Control points are added and solved for.
MapFile mapOf(const SurveyProject& project, const fs::path& output, bool quiet, Progress& progress,
              Diagnostics* diagnostics) {
  const bool is_given = !project.map.empty();
  if (is_given && project.control.empty()) return MapFile::open(project.map, MapFile::Access::Read);
  const fs::path built = output / (project.name + "_built.db");
  if (is_given && fs::exists(built) && fs::equivalent(project.map, built))
    throw UsageError(built.string() + ": the survey writes this file; rename the map of the project");
  for (const char* suffix : {"", "-wal", "-shm"}) fs::remove(built.string() + suffix);
  if (is_given) fs::copy_file(project.map, built);
  MapFile map = MapFile::openOrCreate(built, {});
  if (!is_given) addProjectRuns(project, quiet, progress, &map);
  ControlReadOptions options;
  options.site = map.description().site;
  if (!project.entrance.empty()) options.site = placeFromText(project.entrance, "entrance", diagnostics);
  for (const fs::path& file : project.control) addControlFile(&map, file, options, diagnostics);
  progress.begin("solving");
  MapSolutionOptions solving;
  solving.progress = progress.function();
  reportSolution(solveMap(&map, solving), diagnostics);
  return map;
}

/// What identifies the survey in its folder: map and first stamp.
DiveMap ownerOf(const CaveSurvey& cave, const fs::path& source) {
  DiveMap owner = cave.dives.front();
  owner.name = cave.name;
  owner.run_folder = fs::absolute(source).lexically_normal();
  owner.notes = cave.notes;
  for (const DiveMap& dive : cave.dives) {
    for (const std::string& note : dive.notes) owner.notes.push_back(dive.name + ": " + note);
  }
  return owner;
}

void makeSurvey(const SurveyArguments& arguments) {
  const SurveyProject project = projectOf(arguments);
  Diagnostics diagnostics;
  const fs::path folder = arguments.output;
  createOutputFolder(folder);
  const bool quiet = arguments.verbosity.quiet;
  Progress progress("survey", quiet);
  const MapFile map = mapOf(project, folder, quiet, progress, &diagnostics);
  progress.begin("survey");
  const CaveSurvey cave = caveOfMap(map, project, &diagnostics);
  const DiveMap owner = ownerOf(cave, arguments.project);
  const std::vector<std::pair<std::string, std::string>> files = {
      {cave.name + ".svx", survexCave(cave)},
      {cave.name + ".th", therionCave(cave)},
      {cave.name + ".thconfig", therionConfig(cave.dives.front(), cave.name, {cave.name + ".th"})},
      {cave.name + "_stations.csv", caveStationsCsv(cave)}};
  std::vector<std::string> names;
  for (const auto& [name, text] : files) names.push_back(name);
  if (!arguments.overwrite) expectOwnFiles(folder, owner, names);
  for (const auto& [name, text] : files) writeOutput(folder / name, text);
  writeOutput(folder / notesFileName(cave.name), notesText(owner));
  progress.end();
  if (!quiet) {
    for (const std::string& note : cave.notes) fmt::print("{}\n", note);
    for (const std::string& name : names) fmt::print("written: {}\n", (folder / name).string());
    fmt::print("written: {}\n", (folder / notesFileName(cave.name)).string());
  }
  printFindings(diagnostics, arguments.verbosity);
}

}  // namespace

void addSurveyCommand(CLI::App& program) {
  const auto arguments = std::make_shared<SurveyArguments>();
  CLI::App* command = program.add_subcommand("survey", "Several dives as one cave, for Survex and Therion");
  command->add_option("PROJECT", arguments->project, "project in YAML, or file of a map (cave.db)")
      ->required();
  command->add_option("-o,--output", arguments->output, "folder for the files")->required();
  addOverwrite(&arguments->overwrite, command);
  command->add_option("--name", arguments->name,
                      "name of survey and files; without it, that of the project's file");
  command->add_option("--title", arguments->title, "title of the survey");
  command->add_option("--team", arguments->team, "name of a person of the team; may be repeated");
  command->add_option("--date", arguments->date, "date of dives whose date nothing else states, YYYY-MM-DD");
  command->add_option("--entrance", arguments->entrance,
                      "place of the water's surface above the first pose of the first dive, as in `export`");
  command->add_option("--crs", arguments->crs, "grid, as in `export`");
  command->add_option("--vertical-datum", arguments->vertical_datum,
                      "level that heights count from, as in `export`");
  command->add_option(
      "--merge", arguments->merge_m,
      "largest distance between ways that become one line, m (default: 2.5); 0 keeps every way");
  command->add_option("--spacing", arguments->spacing_m,
                      "distance between stations on a straight way, m (default: 5)");
  addVerbosity(&arguments->verbosity, command);
  command->footer(
      "Options replace the values of the project.\n"
      "Examples:\n"
      "  lodeline survey cave.yaml -o survey\n"
      "  lodeline survey cave.db -o survey --entrance \"29°49'48\\\"N 82°36'W 10\" --date 2026-11-21");
  command->callback([arguments] { makeSurvey(*arguments); });
}

}  // namespace lodeline

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "apps/lodeline/map/map_subcommands.h"
#include "apps/lodeline/shared/common_options.h"
#include "apps/lodeline/shared/start_options.h"
#include "lodeline/diagnostics.h"
#include "lodeline/mapping/session/loops/loop_ledger.h"
#include "lodeline/mapping/session/map_merge.h"
#include "lodeline/mapping/session/map_solution.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

struct MapArguments {
  std::string map;
  std::vector<std::string> runs;
  StartArguments start;
  bool overwrite = false;
  Verbosity verbosity;
};

/// The map of one run: the file itself, or that of a run folder.
fs::path mapOfRun(const std::string& run) {
  const fs::path file = fs::is_directory(run) ? fs::path(run) / "map.db" : fs::path(run);
  if (fs::exists(file)) return file;
  throw InputError(fmt::format(
      "{}: there is no map of this run; `lodeline run` writes map.db, unless loops.enabled=false", run));
}

void printMerged(const MergedDive& dive, bool is_first) {
  const MappingSummary& summary = dive.summary;
  fmt::print("{}: {} keyframes, {} loops accepted, {} refused", dive.name, summary.keyframes,
             summary.accepted, summary.refused);
  if (!is_first) {
    fmt::print(", {} of them with earlier dives; {}", summary.accepted_between_dives,
               summary.is_placed ? "its place in the map is known" : "no place of the map was recognized");
  }
  fmt::print("\n");
  for (const Loop& row : dive.ledger) {
    if (row.source == kTagSource && row.status == LoopStatus::Refused)
      fmt::print("warning [tag_refused]: {}, keyframe {}: {}\n", dive.name, row.new_keyframe, row.reason);
  }
}

void printSolution(const MapSolution& solution) {
  fmt::print("solved: {} dives, {} keyframes, {} loops in use, {} refused by the solution{}\n",
             solution.dives, solution.keyframes, solution.loops, solution.refused_loops,
             solution.converged ? "" : " (not converged)");
  for (const ControlResidual& point : solution.control) {
    const Vec3& r = point.residual_m;
    fmt::print("control point {} ({}): off by {:.2f} {:.2f} {:.2f} m, chi^2 {:.1f}{}\n", point.name,
               point.dive, r.x(), r.y(), r.z(), point.chi_squared,
               point.is_used ? "" : "; not used: " + point.reason);
  }
  for (const std::string& name : solution.unconnected) {
    fmt::print(
        "warning [dive_not_joined]: {} shares no recognized place or control point with the first dive; "
        "its position in the map means nothing\n",
        name);
  }
}

/// The ledger of all dives that were added, beside the map.
fs::path ledgerPath(const std::string& map) { return fs::path(map).replace_extension(".loops.csv"); }

void writeLedger(const MapFile& map) {
  LoopLedger ledger(ledgerPath(map.path()));
  std::map<DiveId, std::string> names;
  for (const MapDive& dive : map.dives()) names[dive.id] = dive.name;
  map.forEachLoop([&](const StoredLoop& row) {
    const StoredKeyframe old_row = *map.keyframe(row.loop.old_keyframe);
    const StoredKeyframe new_row = *map.keyframe(row.loop.new_keyframe);
    ledger.write(row.loop, {names[old_row.keyframe.dive], names[new_row.keyframe.dive], old_row.keyframe.time,
                            new_row.keyframe.time});
  });
}

/// Removes a map with its journals and ledger. A file of another kind is kept, which the caller then refuses.
void removeMap(const std::string& map) {
  if (!fs::exists(map)) return;
  static_cast<void>(MapFile::open(map, MapFile::Access::Read));
  for (const char* journal : {"", "-wal", "-shm"}) fs::remove(map + journal);
  fs::remove(ledgerPath(map));
}

void addRuns(MapFile* map, const MapArguments& arguments) {
  MapMergeOptions options;
  options.mapping.start = arguments.start.start();
  Progress progress("joining dives", arguments.verbosity.quiet);
  for (size_t i = 0; i < arguments.runs.size(); ++i) {
    const std::string& run = arguments.runs[i];
    options.progress = [&](double share) {
      progress.show((static_cast<double>(i) + share) / static_cast<double>(arguments.runs.size()), run);
    };
    const MapFile source = MapFile::open(mapOfRun(run), MapFile::Access::Read);
    const bool is_first = map->dives().empty();
    const MergedDive merged = mergeDive(map, source, options);
    progress.end();
    if (!arguments.verbosity.quiet) printMerged(merged, is_first);
  }
  progress.begin("solving");
  MapSolutionOptions solving;
  solving.progress = progress.function();
  const MapSolution solution = solveMap(map, solving);
  writeLedger(*map);
  progress.end();
  if (arguments.verbosity.quiet) return;
  printSolution(solution);
  fmt::print("written: {}\nwritten: {}\n", map->path().string(), ledgerPath(map->path().string()).string());
}

}  // namespace

void addMapBuildCommands(CLI::App* map) {
  const auto arguments = std::make_shared<MapArguments>();
  CLI::App* build = map->add_subcommand("build", "Make one map of the dives of several runs");
  build->add_option("MAP", arguments->map, "file of the new map")->required();
  build
      ->add_option("RUN", arguments->runs,
                   "folders that `lodeline run` wrote; the first one defines the frame")
      ->required();
  addOverwrite(&arguments->overwrite, build);
  addVerbosity(&arguments->verbosity, build);
  build->callback([arguments] {
    if (arguments->overwrite) removeMap(arguments->map);
    MapFile file = MapFile::create(arguments->map, {});
    addRuns(&file, *arguments);
  });

  CLI::App* add = map->add_subcommand("add", "Add a dive to a map and solve it again");
  add->add_option("MAP", arguments->map, "file of the map")->required();
  add->add_option("RUN", arguments->runs, "folder that `lodeline run` wrote")->required()->expected(1);
  addStartOptions(&arguments->start, add);
  addVerbosity(&arguments->verbosity, add);
  add->callback([arguments] {
    MapFile file = MapFile::open(arguments->map, MapFile::Access::Change);
    addRuns(&file, *arguments);
  });

  CLI::App* solve = map->add_subcommand("solve", "Solve a map again, after dives or control points changed");
  solve->add_option("MAP", arguments->map, "file of the map")->required();
  addVerbosity(&arguments->verbosity, solve);
  solve->callback([arguments] {
    MapFile file = MapFile::open(arguments->map, MapFile::Access::Change);
    Progress progress("solving", arguments->verbosity.quiet);
    MapSolutionOptions solving;
    solving.progress = progress.function();
    const MapSolution solution = solveMap(&file, solving);
    progress.end();
    if (!arguments->verbosity.quiet) printSolution(solution);
  });
}

}  // namespace lodeline

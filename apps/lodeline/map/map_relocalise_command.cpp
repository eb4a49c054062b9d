#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "apps/lodeline/map/map_subcommands.h"
#include "apps/lodeline/shared/common_options.h"
#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/session/relocalizer.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/terminal/progress.h"
#include "lodeline/util/time/time_steps.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

struct RelocaliseArguments {
  std::string map, run, output;
  double clip_s = 3.0;
  Verbosity verbosity;
};

/// Keyframes of a run in clips of equal length.
std::vector<std::vector<MapKeyframe>> clipsOf(const MapFile& run, double clip_s) {
  std::vector<std::vector<MapKeyframe>> clips;
  for (const MapDive& dive : run.dives()) {
    std::vector<KeyframeId> ids;
    run.forEachKeyframe(dive.id, [&](const StoredKeyframe& row) { ids.push_back(row.keyframe.id); });
    clips.emplace_back();
    for (const KeyframeId id : ids) {
      MapKeyframe keyframe = run.fullKeyframe(id);
      const std::vector<MapKeyframe>& clip = clips.back();
      if (!clip.empty() && (keyframe.time - clip.front().time).seconds() > clip_s) clips.emplace_back();
      clips.back().push_back(std::move(keyframe));
    }
  }
  std::erase_if(clips, [](const auto& clip) { return clip.empty(); });
  return clips;
}

std::string rowOf(const MapKeyframe& last, const std::optional<PlaceInMap>& place,
                  const std::string& reason) {
  if (!place) {
    return fmt::format("{},0,nan,nan,nan,nan,nan,nan,nan,nan,nan,nan,0,\"{}\"\n", last.time.nanoseconds(),
                       reason);
  }
  const Vec3& p = place->map_from_body.translation;
  const Quat q = so3::canonical(place->map_from_body.rotation);
  const Vec3 sigma = place->covariance.diagonal().head<3>().cwiseMax(0.0).cwiseSqrt();
  return fmt::format("{},1,{:.4f},{:.4f},{:.4f},{:.9f},{:.9f},{:.9f},{:.9f},{:.4f},{:.4f},{:.4f},{},\n",
                     last.time.nanoseconds(), p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w(), sigma.x(),
                     sigma.y(), sigma.z(), place->loops.size());
}

void relocalise(const RelocaliseArguments& arguments) {
  const fs::path run_file =
      fs::is_directory(arguments.run) ? fs::path(arguments.run) / "map.db" : fs::path(arguments.run);
  const MapFile map = MapFile::open(arguments.map, MapFile::Access::Read);
  const MapFile run = MapFile::open(run_file, MapFile::Access::Read);
  const Relocalizer relocalizer(map);
  std::string text =
      "#timestamp [ns],found,x [m],y [m],z [m],q_x,q_y,q_z,q_w,sigma_x [m],sigma_y [m],sigma_z [m],keyframes,"
      "reason\n";
  int found = 0, clips = 0;
  const std::vector<std::vector<MapKeyframe>> all = clipsOf(run, arguments.clip_s);
  Progress progress("searching the map", arguments.verbosity.quiet);
  for (const std::vector<MapKeyframe>& clip : all) {
    progress.show(static_cast<double>(clips) / static_cast<double>(all.size()));
    std::string reason;
    const std::optional<PlaceInMap> place = relocalizer.find(clip, &reason);
    ++clips;
    found += place ? 1 : 0;
    text += rowOf(clip.back(), place, reason);
  }
  progress.end();
  if (!arguments.verbosity.quiet)
    fmt::print("{} of {} clips of {:g} s found in {}\n", found, clips, arguments.clip_s, arguments.map);
  if (arguments.output.empty()) {
    fmt::print("{}", text);
  } else {
    writeOutput(arguments.output, text);
    if (!arguments.verbosity.quiet) fmt::print("written: {}\n", arguments.output);
  }
}

}  // namespace

void addMapRelocaliseCommand(CLI::App* map) {
  const auto arguments = std::make_shared<RelocaliseArguments>();
  CLI::App* command = map->add_subcommand(
      "relocalise", "Find short clips of a run in a map by what they show, each by itself");
  command->add_option("MAP", arguments->map, "file of the map")->required();
  command->add_option("RUN", arguments->run, "folder that `lodeline run` wrote, or its map.db")->required();
  command->add_option("--clip", arguments->clip_s, "length of a clip")
      ->type_name("SECONDS")
      ->check(CLI::Range(0.1, 30.0))
      ->capture_default_str();
  command->add_option("-o,--output", arguments->output, "CSV file for the poses; without one, the screen");
  addVerbosity(&arguments->verbosity, command);
  command->callback([arguments] { relocalise(*arguments); });
}

}  // namespace lodeline

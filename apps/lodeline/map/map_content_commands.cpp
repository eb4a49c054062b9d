#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/lodeline/map/map_subcommands.h"
#include "lodeline/diagnostics.h"
#include "lodeline/mapping/control/control_residual.h"
#include "lodeline/mapping/store/map_change.h"
#include "lodeline/mapping/store/map_file.h"
#include "lodeline/util/json_text.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {
namespace {

struct ContentArguments {
  std::string map, dive;
  bool json = false;
};

struct DiveContent {
  MapDive dive;
  int keyframes = 0, solved = 0;
  double path_m = 0.0;
};

std::vector<DiveContent> contentOf(const MapFile& map) {
  std::vector<DiveContent> dives;
  for (const MapDive& dive : map.dives()) {
    DiveContent content;
    content.dive = dive;
    std::optional<Vec3> last;
    map.forEachKeyframe(dive.id, [&](const StoredKeyframe& row) {
      ++content.keyframes;
      content.solved += row.solved ? 1 : 0;
      const Vec3& position = row.keyframe.odom_from_body.translation;
      if (last) content.path_m += (position - *last).norm();
      last = position;
    });
    dives.push_back(content);
  }
  return dives;
}

std::map<std::string, int> loopsByStatus(const MapFile& map) {
  std::map<std::string, int> loops;
  map.forEachLoop([&](const StoredLoop& row) { ++loops[toString(row.loop.status)]; });
  return loops;
}

/// Of the control points at the stored solution.
std::vector<ControlPointResidual> residualsOf(const MapFile& map) {
  return controlResiduals(controlFactorsOf(map), [&](KeyframeId id) {
    const std::optional<StoredKeyframe> row = map.keyframe(id);
    return row ? row->solved : std::nullopt;
  });
}

nlohmann::ordered_json infoJson(const MapFile& map) {
  nlohmann::ordered_json json;
  const MapSizes sizes = map.sizes();
  json["file"] = map.path().string();
  json["frame"] = map.description().frame;
  json["dives"] = nlohmann::ordered_json::array();
  for (const DiveContent& content : contentOf(map)) {
    json["dives"].push_back({{"name", content.dive.name},
                             {"recording", content.dive.recording},
                             {"keyframes", content.keyframes},
                             {"solved", content.solved},
                             {"path_m", content.path_m},
                             {"heading_reference", toString(content.dive.heading_reference)},
                             {"is_complete", content.dive.end.has_value()}});
  }
  json["loops"] = loopsByStatus(map);
  json["control_points"] = nlohmann::ordered_json::array();
  for (const ControlPoint& point : map.controlPoints()) {
    json["control_points"].push_back({{"name", point.name}, {"kind", toString(point.kind)}});
    if (point.position) {
      const Vec3& p = point.position->position;
      json["control_points"].back()["position_m"] = {p.x(), p.y(), p.z()};
    }
  }
  json["control_residuals"] = nlohmann::ordered_json::array();
  for (const ControlPointResidual& residual : residualsOf(map)) {
    const Vec3& error = residual.error_m;
    json["control_residuals"].push_back({{"name", residual.name},
                                         {"keyframe", residual.keyframe},
                                         {"error_m", {error.x(), error.y(), error.z()}},
                                         {"chi_squared", residual.chi_squared},
                                         {"is_blunder", residual.is_blunder}});
  }
  json["bytes"] = sizes.file_bytes;
  json["features"] = sizes.features;
  return json;
}

void printInfo(const ContentArguments& arguments) {
  const MapFile map = MapFile::open(arguments.map, MapFile::Access::Read);
  Progress progress("reading", false);
  const nlohmann::ordered_json json = infoJson(map);
  progress.end();
  if (arguments.json) {
    fmt::print("{}\n", jsonText(json));
    return;
  }
  double path_m = 0.0;
  for (const auto& dive : json["dives"]) {
    path_m += dive["path_m"].get<double>();
    fmt::print("dive {:<24} {:>6} keyframes, {:>8.1f} m, {}{}\n", dive["name"].get<std::string>(),
               dive["keyframes"].get<int>(), dive["path_m"].get<double>(),
               dive["solved"] == dive["keyframes"] ? "solved" : "not solved",
               dive["is_complete"].get<bool>() ? "" : ", incomplete");
  }
  std::string loops;
  for (const auto& [status, count] : json["loops"].items())
    loops += fmt::format("{}{} {}", loops.empty() ? "" : ", ", count.get<int>(), status);
  fmt::print("loops: {}\n", loops.empty() ? "none" : loops);
  for (const auto& point : json["control_points"])
    fmt::print("control point {} ({})\n", point["name"].get<std::string>(), point["kind"].get<std::string>());
  const std::vector<ControlPointResidual> residuals = residualsOf(map);
  if (!residuals.empty()) fmt::print("{}", residualTable(residuals));
  for (const std::string& blunder : blunderTexts(residuals)) fmt::print("blunder: {}\n", blunder);
  fmt::print("{:.1f} MB for {:.0f} m of path, {} features\n", 1e-6 * json["bytes"].get<double>(), path_m,
             json["features"].get<int64_t>());
}

void checkMap(const ContentArguments& arguments) {
  const MapFile map = MapFile::open(arguments.map, MapFile::Access::Read);
  Progress progress("checking", false);
  const std::vector<MapFault> faults = map.check();
  progress.end();
  for (const MapFault& fault : faults) fmt::print("serious [{}]: {}\n", fault.kind, fault.text);
  if (!faults.empty())
    throw InputError(fmt::format("{}: {} faults; restore a copy of the map", arguments.map, faults.size()));
  fmt::print("{}: no faults\n", arguments.map);
}

void removeDive(const ContentArguments& arguments) {
  MapFile map = MapFile::open(arguments.map, MapFile::Access::Change);
  const std::optional<MapDive> dive = map.findDive(arguments.dive);
  if (!dive) {
    std::string names;
    for (const MapDive& other : map.dives()) names += (names.empty() ? "" : ", ") + other.name;
    throw UsageError(fmt::format("{}: there is no dive '{}'; there are {}", arguments.map, arguments.dive,
                                 names.empty() ? "none" : names));
  }
  Progress progress("removing", false);
  MapChange change = map.change();
  change.removeDive(dive->id);
  change.commit();
  map.compact();
  progress.end();
  fmt::print("removed: {}; `lodeline map solve {}` solves the rest again\n", arguments.dive, arguments.map);
}

}  // namespace

void addMapContentCommands(CLI::App* map) {
  const auto arguments = std::make_shared<ContentArguments>();
  CLI::App* info = map->add_subcommand("info", "What a map holds");
  info->add_option("MAP", arguments->map, "file of the map")->required();
  info->add_flag("--json", arguments->json, "print JSON");
  info->callback([arguments] { printInfo(*arguments); });

  CLI::App* check = map->add_subcommand("check", "Look for damage in a map");
  check->add_option("MAP", arguments->map, "file of the map")->required();
  check->callback([arguments] { checkMap(*arguments); });

  CLI::App* remove = map->add_subcommand("remove", "Remove a dive from a map");
  remove->add_option("MAP", arguments->map, "file of the map")->required();
  remove->add_option("DIVE", arguments->dive, "name of the dive")->required();
  remove->callback([arguments] { removeDive(*arguments); });
}

}  // namespace lodeline

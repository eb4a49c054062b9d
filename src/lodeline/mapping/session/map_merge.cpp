#include "lodeline/mapping/session/map_merge.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "lodeline/diagnostics.h"
#include "lodeline/mapping/session/map_north.h"
#include "lodeline/mapping/session/map_solution.h"
#include "lodeline/mapping/store/map_change.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

/// A map file that is removed at the end, beside another one.
class TemporaryMap {
 public:
  explicit TemporaryMap(const fs::path& beside)
      : path_(beside.string() + fmt::format(".{}.adding", ::getpid())) {
    remove();
    file_.emplace(MapFile::create(path_, {}));
  }
  ~TemporaryMap() {
    file_.reset();
    remove();
  }
  MapFile& file() { return *file_; }

 private:
  void remove() {
    std::error_code ignored;
    for (const char* suffix : {"", "-wal", "-shm", "-journal"}) fs::remove(path_.string() + suffix, ignored);
  }
  fs::path path_;
  std::optional<MapFile> file_;
};

/// Keyframes of a map that have features.
void addDescribed(const MapFile& map, std::set<KeyframeId>* described) {
  for (const MapDive& dive : map.dives()) {
    map.forEachKeyframe(dive.id, [&](const StoredKeyframe& row) {
      if (row.feature_count > 0) described->insert(row.keyframe.id);
    });
  }
}

/// Keyframes of a new dive that recognized a place and see what an earlier keyframe sees, one that keeps its
/// features: a keyframe of the map, or of the same dive when it was there before. `described`: the keyframes
/// with features.
std::set<KeyframeId> redundantKeyframes(const DiveMapping& mapping, const std::set<KeyframeId>& described,
                                        const MapMergeOptions& options) {
  std::set<KeyframeId> recognized, redundant;
  for (const Loop& loop : mapping.ledger()) {
    if (loop.status == LoopStatus::Accepted && !isTagTie(loop)) recognized.insert(loop.new_keyframe);
  }
  const double least_path_m = options.mapping.candidates.least_path_m;
  for (const KeyframeId id : recognized) {
    const KnownKeyframe& keyframe = mapping.known().at(id);
    const auto seesTheSame = [&](const KnownKeyframe& earlier) {
      if (earlier.id >= id || described.count(earlier.id) == 0 || redundant.count(earlier.id) > 0)
        return false;
      if (earlier.dive == keyframe.dive && keyframe.path_m - earlier.path_m < least_path_m) return false;
      const Rigid3 earlier_from_new = earlier.map_from_body.inverse() * keyframe.map_from_body;
      return earlier_from_new.translation.norm() < options.redundant_distance_m &&
             Quat::Identity().angularDistance(earlier_from_new.rotation) < options.redundant_turn_rad;
    };
    const std::vector<KnownKeyframe>& all = mapping.known().all();
    if (std::any_of(all.begin(), all.end(), seesTheSame)) redundant.insert(id);
  }
  return redundant;
}

/// The tags that a run saw, by keyframe.
std::map<KeyframeId, std::vector<SeenTag>> tagsOf(const MapFile& run) {
  std::map<int64_t, int> tag_of;
  for (const ControlPoint& point : run.controlPoints()) {
    if (point.tag) tag_of[point.id] = *point.tag;
  }
  std::map<KeyframeId, std::vector<SeenTag>> tags;
  for (const ControlObservation& seen : run.controlObservations()) {
    const auto tag = tag_of.find(seen.point);
    if (tag != tag_of.end())
      tags[seen.keyframe].push_back({tag->second, seen.in_body.position, seen.in_body.covariance});
  }
  return tags;
}

/// Tags whose position a run states.
ControlSet statedTags(const MapFile& run) {
  ControlSet tags;
  for (const ControlPoint& point : run.controlPoints()) {
    if (point.tag && point.position) tags.add(point);
  }
  return tags;
}

/// Copies the control points and observations of a dive. Points that the map has keep their position.
void copyControl(const MapFile& source, const MapFile& map, MapChange* change) {
  std::map<std::string, ControlPoint> known;
  for (const ControlPoint& point : map.controlPoints()) known[point.name] = point;
  std::map<int64_t, int64_t> id_of;
  for (const ControlPoint& point : source.controlPoints()) {
    const auto same = known.find(point.name);
    const bool is_complete = same != known.end() && (same->second.position || !point.position);
    id_of[point.id] = is_complete ? same->second.id : change->putControlPoint(point);
  }
  for (ControlObservation seen : source.controlObservations()) {
    seen.point = id_of.at(seen.point);
    change->addControlObservation(seen);
  }
}

void addStart(const DiveStart& start, const std::string& dive, KeyframeId first, MapChange* change) {
  ControlPoint point;
  point.name = "start of " + dive;
  point.kind = ControlKind::Gps;
  point.origin = "as stated for the dive";
  Vec3 sigmas(start.horizontal_sigma_m, start.horizontal_sigma_m, start.vertical_sigma_m);
  point.position = PositionPrior{start.position, sigmas.cwiseAbs2().asDiagonal()};
  ControlObservation seen;
  seen.point = change->putControlPoint(point);
  seen.keyframe = first;
  constexpr double kBody_m = 0.01;  // the body itself is at the point
  seen.in_body.covariance = kBody_m * kBody_m * Mat3::Identity();
  change->addControlObservation(seen);
}

}  // namespace

MergedDive mergeDive(MapFile* map, const MapFile& run, const MapMergeOptions& options) {
  const std::vector<MapDive> dives = run.dives();
  if (dives.empty()) throw InputError(run.path().string() + ": the map of this run has no dive");
  MapDive dive = dives.front();
  if (map->findDive(dive.name)) {
    throw InputError(fmt::format("{}: the map has a dive '{}' already; `lodeline map remove` takes it out",
                                 map->path().string(), dive.name));
  }
  std::vector<KeyframeId> ids;
  run.forEachKeyframe(dives.front().id, [&](const StoredKeyframe& row) { ids.push_back(row.keyframe.id); });
  if (ids.empty()) throw InputError(run.path().string() + ": the dive has no keyframe");
  const bool is_first = map->dives().empty();
  const HeadingReference north_before = northOf(*map);
  MappingOptions mapping_options = options.mapping;
  mapping_options.tags = statedTags(run);

  TemporaryMap temporary(map->path());
  DiveMapping mapping(&temporary.file(), dive, is_first ? nullptr : map, mapping_options);
  const std::map<KeyframeId, std::vector<SeenTag>> tags = tagsOf(run);
  double done = 0.0;
  for (const KeyframeId id : ids) {
    options.progress(done++ / static_cast<double>(ids.size()));
    MapKeyframe keyframe = run.fullKeyframe(id);
    if (const auto seen = tags.find(id); seen != tags.end()) keyframe.tags = seen->second;
    mapping.add(std::move(keyframe));
  }
  MergedDive merged;
  merged.name = dive.name;
  merged.summary = mapping.finish(dive.end.value_or(dive.start));
  merged.ledger = mapping.ledger();
  std::set<KeyframeId> described;
  addDescribed(*map, &described);
  addDescribed(temporary.file(), &described);
  const std::set<KeyframeId> redundant = redundantKeyframes(mapping, described, options);
  merged.without_features = static_cast<int>(redundant.size());

  const MapFile& source = temporary.file();
  const DiveId from = source.dives().front().id;
  MapChange change = map->change();
  const DiveId to = change.addDive(dive);
  std::vector<StoredKeyframe> rows;
  source.forEachKeyframe(from, [&](const StoredKeyframe& row) { rows.push_back(row); });
  for (const StoredKeyframe& row : rows) {
    MapKeyframe keyframe = row.keyframe;
    keyframe.dive = to;
    if (redundant.count(keyframe.id) == 0) keyframe.features = source.features(keyframe.id);
    change.addKeyframe(keyframe);
    if (row.solved) change.setSolution(keyframe.id, *row.solved);
  }
  source.forEachEdge(from, [&](const OdometryEdge& edge) { change.addEdge(edge); });
  for (const Loop& loop : merged.ledger) {
    if (!isTagTie(loop)) change.addLoop(loop);
  }
  copyControl(source, *map, &change);
  if (options.mapping.start) addStart(*options.mapping.start, dive.name, rows.front().keyframe.id, &change);
  change.commit();
  // Poses of later dives are compared with the y axis of the map, which must be its north.
  if (!is_first && northOf(*map) != north_before)
    solveMap(map, {options.mapping.graph, options.mapping.factors});
  return merged;
}

}  // namespace lodeline

#include "lodeline/mapping/store/map_change.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "lodeline/mapping/store/pack/feature_block.h"
#include "lodeline/mapping/store/pack/packed_covariance.h"
#include "lodeline/mapping/store/row_columns.h"

namespace lodeline {
namespace {

void requireRow(const Database& database, const char* what, int64_t id) {
  if (database.changedRows() == 0)
    throw InputError(fmt::format("{}: there is no {} {}", database.path().string(), what, id));
}

void bindDive(const MapDive& dive, Query* query) {
  query->text(dive.name).text(dive.recording).text(dive.fingerprint).integer(dive.start.nanoseconds());
  query->integerOrNull(dive.end ? std::optional(dive.end->nanoseconds()) : std::nullopt);
  query->text(toString(dive.heading_reference)).text(dive.rig).text(dive.corrections);
  query->text(dive.depth_reference).text(dive.field_reference).text(dive.settings_digest);
}

void refuseTakenName(Database* database, const MapDive& dive, DiveId own_id) {
  if (dive.name.empty()) throw InputError(fmt::format("{}: a dive needs a name", database->path().string()));
  Query query = database->query("SELECT id FROM dive WHERE name = ?");
  query.text(dive.name);
  if (query.next() && query.integerAt(0) != own_id) {
    throw InputError(fmt::format("{}: has a dive '{}' already; choose another name or remove that dive",
                                 database->path().string(), dive.name));
  }
}

}  // namespace

MapChange::MapChange(Database* database) : database_(database) {}
MapChange::MapChange(MapChange&& other) noexcept : database_(std::exchange(other.database_, nullptr)) {}

MapChange::~MapChange() {
  if (database_ == nullptr || !database_->inTransaction()) return;
  try {
    database_->run("ROLLBACK");
  } catch (const InputError&) {
    // The file cannot be written. The next program that opens it finds the map before this change.
  }
}

void MapChange::commit() {
  database_->run("COMMIT");
  database_ = nullptr;
}

void MapChange::setDescription(const MapDescription& description) {
  database_->run("DELETE FROM map");
  const auto set = [&](const char* key, const std::string& value) {
    database_->query("INSERT INTO map (key, value) VALUES (?, ?)").text(key).text(value).run();
  };
  set("frame", description.frame);
  set("field_reference", description.field_reference);
  if (!description.site) return;
  set("site_latitude_deg", fmt::format("{}", description.site->latitude_deg));
  set("site_longitude_deg", fmt::format("{}", description.site->longitude_deg));
  set("site_height_m", fmt::format("{}", description.site->height_m));
}

DiveId MapChange::addDive(const MapDive& dive) {
  refuseTakenName(database_, dive, -1);
  Query query = database_->query(
      "INSERT INTO dive (name, recording, fingerprint, start_ns, end_ns, heading_reference, rig, "
      "corrections, "
      "depth_reference, field_reference, settings_digest) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  bindDive(dive, &query);
  query.run();
  return static_cast<DiveId>(database_->lastRow());
}

void MapChange::updateDive(const MapDive& dive) {
  refuseTakenName(database_, dive, dive.id);
  Query query = database_->query(
      "UPDATE dive SET name = ?, recording = ?, fingerprint = ?, start_ns = ?, end_ns = ?, heading_reference "
      "= ?, "
      "rig = ?, corrections = ?, depth_reference = ?, field_reference = ?, settings_digest = ? WHERE id = ?");
  bindDive(dive, &query);
  query.integer(dive.id).run();
  requireRow(*database_, "dive", dive.id);
}

void MapChange::removeDive(DiveId dive) {
  database_->query("DELETE FROM dive WHERE id = ?").integer(dive).run();
  requireRow(*database_, "dive", dive);
  database_->run(
      "DELETE FROM control_point WHERE x IS NULL AND id NOT IN (SELECT point FROM control_observation)");
}

KeyframeId MapChange::addKeyframe(const MapKeyframe& keyframe) {
  const KeyframeId newest = database_->number("SELECT seq FROM sqlite_sequence WHERE name = 'keyframe'");
  const KeyframeId id = keyframe.id < 0 ? newest + 1 : keyframe.id;
  if (id <= newest)
    throw InputError(fmt::format("{}: keyframe {} comes after {}", database_->path().string(), id, newest));
  withRowName(*database_, "keyframe", id, [&] {
    Query query = database_->query(
        "INSERT INTO keyframe (id, dive, time_ns, x, y, z, qx, qy, qz, qw, covariance, "
        "north_from_odom_rad, heading_sigma_rad, depth_m, depth_sigma_m) "
        "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
    query.integer(id).integer(keyframe.dive).integer(keyframe.time.nanoseconds());
    bindPose(keyframe.odom_from_body, &query);
    query.blob(packCovariance<6>(keyframe.covariance));
    bindFinite(keyframe.north_from_odom_rad, &query);
    if (keyframe.heading_sigma_rad)
      bindFinite(*keyframe.heading_sigma_rad, &query);
    else
      query.null();
    if (keyframe.depth_m) {
      bindFinite(keyframe.depth_m->value, &query);
      bindFinite(keyframe.depth_m->sigma, &query);
    }
    query.run();
    if (keyframe.field) addField(id, *keyframe.field);
    if (keyframe.features.empty()) return;
    const Bytes data = packFeatures(keyframe.features);
    database_->query("INSERT INTO features (keyframe, count, data) VALUES (?, ?, ?)")
        .integer(id)
        .integer(static_cast<int64_t>(keyframe.features.size()))
        .blob(data)
        .run();
  });
  return id;
}

void MapChange::addField(KeyframeId id, const KeyframeField& field) {
  Query query = database_->query("INSERT INTO field (keyframe, x, y, z, sigma) VALUES (?, ?, ?, ?, ?)");
  query.integer(id);
  bindPoint(field.field_B, &query);
  bindFinite(field.sigma_T, &query);
  query.run();
}

void MapChange::removeKeyframe(KeyframeId id) {
  database_->query("DELETE FROM keyframe WHERE id = ?").integer(id).run();
  requireRow(*database_, "keyframe", id);
}

void MapChange::setSolution(KeyframeId id, const SolvedPose& pose) {
  withRowName(*database_, "solution of keyframe", id, [&] {
    Query query = database_->query(
        "INSERT OR REPLACE INTO solution (keyframe, x, y, z, qx, qy, qz, qw, covariance) "
        "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)");
    query.integer(id);
    bindPose(pose.map_from_body, &query);
    query.blob(packCovariance<6>(pose.covariance)).run();
  });
}

void MapChange::clearSolution() { database_->run("DELETE FROM solution"); }

void MapChange::addEdge(const OdometryEdge& edge) {
  withRowName(*database_, "edge to keyframe", edge.new_keyframe, [&] {
    Query query = database_->query(
        "INSERT INTO edge (old_keyframe, new_keyframe, x, y, z, qx, qy, qz, qw, covariance) "
        "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
    query.integer(edge.old_keyframe).integer(edge.new_keyframe);
    bindPose(edge.old_from_new, &query);
    query.blob(packCovariance<6>(edge.covariance)).run();
  });
}

}  // namespace lodeline

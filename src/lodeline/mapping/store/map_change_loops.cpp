#include <fmt/format.h>

#include <limits>

#include "lodeline/mapping/store/map_change.h"
#include "lodeline/mapping/store/pack/packed_covariance.h"
#include "lodeline/mapping/store/row_columns.h"

namespace lodeline {
namespace {

Bytes packMatches(const std::vector<FeatureMatch>& matches) {
  ByteWriter writer;
  for (const FeatureMatch& match : matches) {
    for (const int feature : {match.old_feature, match.new_feature}) {
      if (feature < 0 || feature > std::numeric_limits<uint16_t>::max())
        throw InputError(fmt::format("a match has the feature {}", feature));
      writer.integer(static_cast<uint16_t>(feature));
    }
  }
  return writer.bytes();
}

void bindLoop(const Loop& loop, Query* query) {
  query->integer(loop.old_keyframe).integer(loop.new_keyframe);
  query->text(loop.source).text(toString(loop.status)).text(loop.reason);
  query->integer(loop.matches).integer(loop.inliers);
  bindFinite(loop.covered_share, query);
  bindFinite(loop.rms_sigmas, query);
  bindFinite(loop.mahalanobis_squared, query);
  bindPose(loop.old_from_new, query);
  query->blob(packCovariance<6>(loop.covariance)).blob(packMatches(loop.inlier_matches));
}

}  // namespace

int64_t MapChange::addLoop(const Loop& loop) {
  withRowName(*database_, "loop to keyframe", loop.new_keyframe, [&] {
    Query query = database_->query(
        "INSERT INTO loop (old_keyframe, new_keyframe, source, status, reason, matches, inliers, "
        "covered_share, "
        "rms_sigmas, mahalanobis_squared, x, y, z, qx, qy, qz, qw, covariance, inlier_matches) "
        "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
    bindLoop(loop, &query);
    query.run();
  });
  return database_->lastRow();
}

void MapChange::updateLoop(const StoredLoop& stored) {
  withRowName(*database_, "loop", stored.id, [&] {
    Query query = database_->query(
        "UPDATE loop SET old_keyframe = ?, new_keyframe = ?, source = ?, status = ?, reason = ?, matches = "
        "?, "
        "inliers = ?, covered_share = ?, rms_sigmas = ?, mahalanobis_squared = ?, x = ?, y = ?, z = ?, qx = "
        "?, "
        "qy = ?, qz = ?, qw = ?, covariance = ?, inlier_matches = ? WHERE id = ?");
    bindLoop(stored.loop, &query);
    query.integer(stored.id).run();
    if (database_->changedRows() == 0) throw InputError("there is no such loop");
  });
}

void MapChange::clearLoops() { database_->run("DELETE FROM loop"); }

int64_t MapChange::putControlPoint(const ControlPoint& point) {
  if (point.name.empty())
    throw InputError(fmt::format("{}: a control point needs a name", database_->path().string()));
  std::optional<int64_t> id;
  {
    Query found = database_->query("SELECT id FROM control_point WHERE name = ?");
    found.text(point.name);
    if (found.next()) id = found.integerAt(0);
  }
  Query query = database_->query(
      "INSERT INTO control_point (id, name, kind, tag, x, y, z, covariance, origin) "
      "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT (id) DO UPDATE SET kind = excluded.kind, "
      "tag = excluded.tag, x = excluded.x, y = excluded.y, z = excluded.z, covariance = excluded.covariance, "
      "origin = excluded.origin");
  try {
    query.integerOrNull(id).text(point.name).text(toString(point.kind));
    query.integerOrNull(point.tag ? std::optional<int64_t>(*point.tag) : std::nullopt);
    if (point.position) {
      bindPoint(point.position->position, &query);
      query.blob(packCovariance<3>(point.position->covariance));
    } else {
      query.null().null().null().null();
    }
    query.text(point.origin).run();
  } catch (const InputError& error) {
    throw InputError(fmt::format("control point '{}': {}", point.name, error.what()));
  }
  return id ? *id : database_->lastRow();
}

void MapChange::removeControlPoint(int64_t id) {
  database_->query("DELETE FROM control_point WHERE id = ?").integer(id).run();
  if (database_->changedRows() == 0)
    throw InputError(fmt::format("{}: there is no control point {}", database_->path().string(), id));
}

void MapChange::addControlObservation(const ControlObservation& observation) {
  withRowName(*database_, "observation of control point", observation.point, [&] {
    Query query = database_->query(
        "INSERT INTO control_observation (point, keyframe, x, y, z, covariance) VALUES (?, ?, ?, ?, ?, ?)");
    query.integer(observation.point).integer(observation.keyframe);
    bindPoint(observation.in_body.position, &query);
    query.blob(packCovariance<3>(observation.in_body.covariance)).run();
  });
}

}  // namespace lodeline

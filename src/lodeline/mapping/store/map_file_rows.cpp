#include <fmt/format.h>

#include "lodeline/mapping/store/map_file.h"
#include "lodeline/mapping/store/map_rows.h"
#include "lodeline/mapping/store/pack/feature_block.h"
#include "lodeline/mapping/store/row_columns.h"

namespace lodeline {
namespace {

/// Rows read at a time: memory stays bounded, and the caller may change the map between two reads.
constexpr int kBatch = 256;

}  // namespace

void MapFile::forEachKeyframe(DiveId dive, const std::function<void(const StoredKeyframe&)>& use) const {
  KeyframeId last = -1;
  for (std::vector<StoredKeyframe> batch;; batch.clear()) {
    {
      Query query = database_->query(rows::kSelectKeyframes);
      query.integer(dive).integer(last).integer(kBatch);
      while (query.next()) {
        batch.push_back(
            withRowName(*database_, "keyframe", query.integerAt(0), [&] { return rows::keyframeAt(query); }));
      }
    }
    for (const StoredKeyframe& stored : batch) use(stored);
    if (batch.size() < kBatch) return;
    last = batch.back().keyframe.id;
  }
}

std::optional<StoredKeyframe> MapFile::keyframe(KeyframeId id) const {
  Query query = database_->query(rows::kSelectKeyframe);
  query.integer(id);
  if (!query.next()) return std::nullopt;
  return withRowName(*database_, "keyframe", id, [&] { return rows::keyframeAt(query); });
}

std::vector<MapFeature> MapFile::features(KeyframeId id) const {
  Query query = database_->query("SELECT data FROM features WHERE keyframe = ?");
  query.integer(id);
  if (!query.next()) return {};
  return withRowName(*database_, "features of keyframe", id, [&] { return unpackFeatures(query.blobAt(0)); });
}

MapKeyframe MapFile::fullKeyframe(KeyframeId id) const {
  std::optional<StoredKeyframe> stored = keyframe(id);
  if (!stored) throw InputError(fmt::format("{}: there is no keyframe {}", path_.string(), id));
  stored->keyframe.features = features(id);
  return std::move(stored->keyframe);
}

void MapFile::forEachEdge(DiveId dive, const std::function<void(const OdometryEdge&)>& use) const {
  KeyframeId last_new = -1, last_old = -1;
  for (std::vector<OdometryEdge> batch;; batch.clear()) {
    {
      Query query = database_->query(rows::kSelectEdges);
      query.integer(dive).integer(last_new).integer(last_old).integer(kBatch);
      while (query.next()) {
        batch.push_back(withRowName(*database_, "edge to keyframe", query.integerAt(1),
                                    [&] { return rows::edgeAt(query); }));
      }
    }
    for (const OdometryEdge& edge : batch) use(edge);
    if (batch.size() < kBatch) return;
    last_new = batch.back().new_keyframe;
    last_old = batch.back().old_keyframe;
  }
}

void MapFile::forEachLoop(const std::function<void(const StoredLoop&)>& use) const {
  int64_t last = -1;
  for (std::vector<StoredLoop> batch;; batch.clear()) {
    {
      Query query = database_->query(rows::kSelectLoops);
      query.integer(last).integer(kBatch);
      while (query.next()) {
        batch.push_back(
            withRowName(*database_, "loop", query.integerAt(0), [&] { return rows::loopAt(query); }));
      }
    }
    for (const StoredLoop& stored : batch) use(stored);
    if (batch.size() < kBatch) return;
    last = batch.back().id;
  }
}

std::vector<ControlPoint> MapFile::controlPoints() const {
  std::vector<ControlPoint> points;
  Query query = database_->query(rows::kSelectPoints);
  while (query.next()) {
    points.push_back(withRowName(*database_, "control_point", query.integerAt(0),
                                 [&] { return rows::pointRowAt(query); }));
  }
  return points;
}

std::vector<ControlObservation> MapFile::controlObservations() const {
  std::vector<ControlObservation> observations;
  Query query = database_->query(rows::kSelectObservations);
  while (query.next()) {
    observations.push_back(withRowName(*database_, "observation of control point", query.integerAt(0),
                                       [&] { return rows::observationAt(query); }));
  }
  return observations;
}

}  // namespace lodeline

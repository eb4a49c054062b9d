#include "lodeline/mapping/store/map_rows.h"

#include <fmt/format.h>

#include "lodeline/mapping/store/pack/packed_covariance.h"
#include "lodeline/mapping/store/row_columns.h"

namespace lodeline {

bool isUnfinishedMap(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return true;
  if (std::filesystem::is_directory(file) || std::filesystem::file_size(file) > 65536) return false;
  if (std::filesystem::file_size(file) == 0) return true;
  Database database(file, Database::Mode::Read);
  return database.number("PRAGMA application_id") == 0 &&
         database.number("SELECT count(*) FROM sqlite_master") == 0;
}

namespace rows {
namespace {

HeadingReference headingReferenceFrom(const std::string& word) {
  // A result is never Automatic.
  for (const HeadingReference reference :
       {HeadingReference::True, HeadingReference::Magnetic, HeadingReference::Start}) {
    if (word == toString(reference)) return reference;
  }
  throw InputError(fmt::format("unknown heading reference '{}'", word));
}

LoopStatus loopStatusFrom(const std::string& word) {
  for (const LoopStatus status : {LoopStatus::Candidate, LoopStatus::Matched, LoopStatus::Verified,
                                  LoopStatus::Accepted, LoopStatus::Refused}) {
    if (word == toString(status)) return status;
  }
  throw InputError(fmt::format("unknown status of a loop '{}'", word));
}

}  // namespace

MapDive diveAt(const Query& query) {
  MapDive dive;
  dive.id = static_cast<DiveId>(query.integerAt(0));
  dive.name = query.textAt(1);
  dive.recording = query.textAt(2);
  dive.fingerprint = query.textAt(3);
  dive.start = Time::fromNanoseconds(query.integerAt(4));
  if (!query.isNull(5)) dive.end = Time::fromNanoseconds(query.integerAt(5));
  dive.heading_reference = headingReferenceFrom(query.textAt(6));
  dive.rig = query.textAt(7);
  dive.corrections = query.textAt(8);
  dive.depth_reference = query.textAt(9);
  dive.field_reference = query.textAt(10);
  dive.settings_digest = query.textAt(11);
  return dive;
}

StoredKeyframe keyframeAt(const Query& query) {
  StoredKeyframe stored;
  MapKeyframe& keyframe = stored.keyframe;
  keyframe.id = query.integerAt(0);
  keyframe.dive = static_cast<DiveId>(query.integerAt(1));
  keyframe.time = Time::fromNanoseconds(query.integerAt(2));
  keyframe.odom_from_body = poseAt(query, 3);
  keyframe.covariance = unpackCovariance<6>(query.blobAt(10));
  keyframe.north_from_odom_rad = finiteAt(query, 23);
  if (!query.isNull(11)) keyframe.heading_sigma_rad = finiteAt(query, 11);
  if (!query.isNull(12)) keyframe.depth_m = ScalarPrior{finiteAt(query, 12), finiteAt(query, 13)};
  stored.feature_count = static_cast<int>(query.integerAt(14));
  if (!query.isNull(15)) stored.solved = SolvedPose{poseAt(query, 15), unpackCovariance<6>(query.blobAt(22))};
  if (!query.isNull(24)) keyframe.field = KeyframeField{pointAt(query, 24), finiteAt(query, 27)};
  return stored;
}

OdometryEdge edgeAt(const Query& query) {
  return {query.integerAt(0), query.integerAt(1), poseAt(query, 2), unpackCovariance<6>(query.blobAt(9))};
}

StoredLoop loopAt(const Query& query) {
  StoredLoop stored;
  stored.id = query.integerAt(0);
  Loop& loop = stored.loop;
  loop.old_keyframe = query.integerAt(1);
  loop.new_keyframe = query.integerAt(2);
  loop.source = query.textAt(3);
  loop.status = loopStatusFrom(query.textAt(4));
  loop.reason = query.textAt(5);
  loop.matches = static_cast<int>(query.integerAt(6));
  loop.inliers = static_cast<int>(query.integerAt(7));
  loop.covered_share = finiteAt(query, 8);
  loop.rms_sigmas = finiteAt(query, 9);
  loop.mahalanobis_squared = finiteAt(query, 10);
  loop.old_from_new = poseAt(query, 11);
  loop.covariance = unpackCovariance<6>(query.blobAt(18));
  ByteReader reader(query.blobAt(19));
  while (reader.left() > 0) {
    const auto old_feature = reader.integer<uint16_t>();
    loop.inlier_matches.push_back({old_feature, reader.integer<uint16_t>()});
  }
  return stored;
}

ControlPoint pointRowAt(const Query& query) {
  ControlPoint point;
  point.id = query.integerAt(0);
  point.name = query.textAt(1);
  const auto kind = controlKindFrom(query.textAt(2));
  if (!kind) throw InputError(fmt::format("unknown kind of control point '{}'", query.textAt(2)));
  point.kind = *kind;
  if (!query.isNull(3)) point.tag = static_cast<int>(query.integerAt(3));
  if (!query.isNull(4))
    point.position = PositionPrior{pointAt(query, 4), unpackCovariance<3>(query.blobAt(7))};
  point.origin = query.textAt(8);
  return point;
}

ControlObservation observationAt(const Query& query) {
  ControlObservation observation;
  observation.point = query.integerAt(0);
  observation.keyframe = query.integerAt(1);
  observation.in_body = {pointAt(query, 2), unpackCovariance<3>(query.blobAt(5))};
  return observation;
}

}  // namespace rows
}  // namespace lodeline

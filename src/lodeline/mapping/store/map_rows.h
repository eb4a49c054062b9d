#pragma once

#include <filesystem>

#include "lodeline/mapping/store/map_records.h"
#include "lodeline/mapping/store/sqlite/database.h"

namespace lodeline {

/// Whether there is no map yet: no file, or one without any table, as a kill during the creation leaves it.
bool isUnfinishedMap(const std::filesystem::path& file);

/// Rows of the tables as records. Each select lists the columns that its function reads, in their order.
namespace rows {

constexpr const char* kSelectDives =
    "SELECT id, name, recording, fingerprint, start_ns, end_ns, heading_reference, rig, corrections, "
    "depth_reference, field_reference, settings_digest FROM dive ORDER BY id";
MapDive diveAt(const Query& query);

#define LODELINE_SELECT_KEYFRAME                                                               \
  "SELECT k.id, k.dive, k.time_ns, k.x, k.y, k.z, k.qx, k.qy, k.qz, k.qw, k.covariance, "      \
  "k.heading_sigma_rad, "                                                                      \
  "k.depth_m, k.depth_sigma_m, f.count, s.x, s.y, s.z, s.qx, s.qy, s.qz, s.qw, s.covariance, " \
  "k.north_from_odom_rad, m.x, m.y, m.z, m.sigma FROM keyframe k "                             \
  "LEFT JOIN features f ON f.keyframe = k.id LEFT JOIN solution s ON s.keyframe = k.id "       \
  "LEFT JOIN field m ON m.keyframe = k.id "
constexpr const char* kSelectKeyframe = LODELINE_SELECT_KEYFRAME "WHERE k.id = ?";
constexpr const char* kSelectKeyframes =
    LODELINE_SELECT_KEYFRAME "WHERE k.dive = ? AND k.id > ? ORDER BY k.id LIMIT ?";
#undef LODELINE_SELECT_KEYFRAME
StoredKeyframe keyframeAt(const Query& query);

constexpr const char* kSelectEdges =
    "SELECT e.old_keyframe, e.new_keyframe, e.x, e.y, e.z, e.qx, e.qy, e.qz, e.qw, e.covariance "
    "FROM edge e JOIN keyframe k ON k.id = e.new_keyframe "
    "WHERE k.dive = ? AND (e.new_keyframe, e.old_keyframe) > (?, ?) "
    "ORDER BY e.new_keyframe, e.old_keyframe LIMIT ?";
OdometryEdge edgeAt(const Query& query);

constexpr const char* kSelectLoops =
    "SELECT id, old_keyframe, new_keyframe, source, status, reason, matches, inliers, covered_share, "
    "rms_sigmas, mahalanobis_squared, x, y, z, qx, qy, qz, qw, covariance, inlier_matches FROM loop "
    "WHERE id > ? ORDER BY id LIMIT ?";
StoredLoop loopAt(const Query& query);

constexpr const char* kSelectPoints =
    "SELECT id, name, kind, tag, x, y, z, covariance, origin FROM control_point ORDER BY id";
ControlPoint pointRowAt(const Query& query);

constexpr const char* kSelectObservations =
    "SELECT point, keyframe, x, y, z, covariance FROM control_observation ORDER BY id";
ControlObservation observationAt(const Query& query);

}  // namespace rows
}  // namespace lodeline

#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "lodeline/estimate.h"
#include "lodeline/mapping/keyframe/map_keyframe.h"
#include "lodeline/types.h"

/// The rows of a map file, except those of map_keyframe.h. docs/reference/map-file.md describes the tables.
namespace lodeline {

/// What holds for the map as a whole.
struct MapDescription {
  std::string frame = "east, north, up";  ///< axes of the map frame, in words
  std::optional<GeodeticPosition> site;   ///< of the origin of the map frame
  std::string field_reference;            ///< model and date of the Earth's field that gives true north
  bool operator==(const MapDescription&) const;
};

/// Identifies a dive within one map. Numbers of removed dives are not used again.
using DiveId = int;

/// One dive of a map.
struct MapDive {
  DiveId id = -1;           ///< set by the map file
  std::string name;         ///< unique in the map, not empty
  std::string recording;    ///< path of the recording, as given
  std::string fingerprint;  ///< identifies the recording's content; may be empty
  Time start;
  std::optional<Time> end;  ///< empty while the dive is being recorded, or where the program was killed
  HeadingReference heading_reference = HeadingReference::Start;
  std::string rig;              ///< text of the rig file, as the run used it
  std::string corrections;      ///< calibration that the run estimated, as YAML; may be empty
  std::string depth_reference;  ///< what depth 0 is, in words; may be empty
  std::string field_reference;  ///< model and date of the Earth's field; may be empty
  std::string settings_digest;  ///< of the settings of the run; may be empty
};

/// Pose of a keyframe in the common solution of a map, with the covariance of [dp, dtheta] in map axes.
struct SolvedPose {
  Rigid3 map_from_body;
  Mat6 covariance = Mat6::Zero();
};

/// A keyframe without its features, as rows are iterated.
struct StoredKeyframe {
  MapKeyframe keyframe;  ///< `features` is empty; MapFile::features() reads them
  int feature_count = 0;
  std::optional<SolvedPose> solved;
};

/// Relative pose of two keyframes of one dive by odometry, with the covariance of [dp, dtheta] in axes of the
/// old body: true = (exp(dtheta) R, p + dp).
struct OdometryEdge {
  KeyframeId old_keyframe = -1;
  KeyframeId new_keyframe = -1;
  Rigid3 old_from_new;
  Mat6 covariance = Mat6::Identity();
};

/// A row of the ledger and its number, which rises in the order of addition.
struct StoredLoop {
  int64_t id = -1;
  Loop loop;
};

/// What marks a control point.
enum class ControlKind {
  Gps,      ///< position fix at the surface
  Station,  ///< of a survey
  Tag,      ///< AprilTag, identified by its number
  Tie,      ///< tie-off or other mark, identified by its name
};
const char* toString(ControlKind kind);
/// Nothing for a word that is not the name of a kind.
std::optional<ControlKind> controlKindFrom(const std::string& word);

/// A normal distribution of a position.
struct PositionPrior {
  Vec3 position = Vec3::Zero();  ///< m
  Mat3 covariance = Mat3::Identity();
};

/// A named point of the cave. Where its position is unknown, all observations of it show the same point.
struct ControlPoint {
  int64_t id = -1;   ///< set by the map file
  std::string name;  ///< unique in the map, not empty
  ControlKind kind = ControlKind::Station;
  std::optional<int> tag;                 ///< number of the AprilTag
  std::optional<PositionPrior> position;  ///< in the map frame
  std::string origin;                     ///< where it was stated: file and line
};

/// A control point as seen or touched at a keyframe: its position in the body frame.
struct ControlObservation {
  int64_t point = -1;  ///< ControlPoint::id
  KeyframeId keyframe = -1;
  PositionPrior in_body;
};

/// A fault of a map file.
struct MapFault {
  std::string kind;  ///< stable identifier, e.g. "map_features"
  std::string text;
};

/// Bytes of a map file and numbers of its rows.
struct MapSizes {
  int64_t file_bytes = 0;  ///< with the write-ahead log
  int64_t free_bytes = 0;  ///< of these unused, to be filled by the next dive
  int64_t feature_bytes = 0;
  int64_t dives = 0, keyframes = 0, features = 0, edges = 0, loops = 0, control_points = 0;
};

}  // namespace lodeline

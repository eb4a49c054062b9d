#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/estimate.h"
#include "lodeline/mapping/keyframe/descriptor.h"
#include "lodeline/types.h"

namespace lodeline {

/// Identifies a keyframe within one map; rises in the order in which keyframes were added.
using KeyframeId = int64_t;

/// A viewing ray in the body frame, with the calibration in effect when it was observed. Rays of different
/// rigs are therefore comparable without their calibrations.
struct BodyRay {
  int camera = 0;                  ///< index into the cameras of the keyframe's rig
  Vec2 pixel = Vec2::Zero();       ///< in the image as recorded
  Vec3 origin_B = Vec3::Zero();    ///< point of the ray next to the camera's centre, m
  Vec3 bearing_B = Vec3::UnitZ();  ///< unit, away from the camera
  double sigma_rad = 1e-3;         ///< standard deviation of the bearing along each axis
};

/// A point in the image of camera 0 with its descriptor, its rays and, where it is known, its position.
struct MapFeature {
  TrackId track = -1;  ///< of the front end; -1 for a corner that was not tracked
  Descriptor descriptor;
  std::vector<BodyRay> rays;      ///< at most one for each camera; camera 0 first
  std::optional<Vec3> point_B;    ///< position in the body frame at the keyframe's time, m
  double distance_sigma_m = 0.0;  ///< of that position along the first ray; across it the ray's sigma holds
};

/// An AprilTag seen at a keyframe.
struct SeenTag {
  int tag = 0;                         ///< its number
  Vec3 centre_B = Vec3::Zero();        ///< position of its centre in the body frame, m
  Mat3 covariance = Mat3::Identity();  ///< of that position, m^2
};

/// The magnetic field at a keyframe, used by the estimator or not.
struct KeyframeField {
  Vec3 field_B = Vec3::Zero();  ///< body axes, without hard iron and fields of currents, T
  double sigma_T = 0.0;         ///< of its independent noise, per axis
};

/// What a map keeps of one moment of a dive.
struct MapKeyframe {
  KeyframeId id = -1;
  int dive = 0;  ///< index of the dive in the map
  Time time;
  /// By the odometry of its dive. The z axis of the world is up, so roll and pitch hold in every world.
  Rigid3 odom_from_body;
  /// Reported covariance of [dp, dtheta] in world axes, relative to the first pose of the dive.
  Mat6 covariance = Mat6::Zero();
  /// Rotation about the vertical from the odometry's world to north, as estimated at this keyframe, rad, and
  /// one sigma of the heading; empty where the magnetometer does not give north.
  double north_from_odom_rad = 0.0;
  std::optional<double> heading_sigma_rad;
  /// Depth of the body below the surface by the pressure sensor and the density of the water as estimated at
  /// this keyframe, and one sigma, m. Errors of the density are common to a dive.
  std::optional<ScalarPrior> depth_m;
  std::vector<MapFeature> features;
  std::vector<SeenTag> tags;           ///< a map keeps them as observations of control points
  std::optional<KeyframeField> field;  ///< empty without a magnetometer
};

/// A feature of an old keyframe and one of a new keyframe that show the same point: indices.
struct FeatureMatch {
  int old_feature = -1;
  int new_feature = -1;
};

/// How far a candidate for a loop came.
enum class LoopStatus {
  Candidate,  ///< chosen by geometry or appearance
  Matched,    ///< enough descriptors agree
  Verified,   ///< one rigid motion explains enough of them, and it agrees with the prediction
  Accepted,   ///< used
  Refused,    ///< by a later check; `reason` says by which
};
const char* toString(LoopStatus status);

/// Agreement of the magnetic fields along both ways of a loop, given its pose.
struct FieldAgreement {
  double chi_squared = 0.0;  ///< of the new way's readings, predicted from those of the old way
  int values = 0;            ///< its degrees of freedom
  /// Natural logarithm of the likelihood of these readings at this place over that at any other place.
  double log_ratio = 0.0;
};

/// A pair of keyframes that may show the same place, and what became of it: one row of the ledger.
struct Loop {
  KeyframeId old_keyframe = -1;
  KeyframeId new_keyframe = -1;
  std::string source;  ///< why it was a candidate: geometry, appearance, cloud or control
  LoopStatus status = LoopStatus::Candidate;
  std::string reason;                ///< for which it went no further, in words; empty where accepted
  int matches = 0;                   ///< descriptors that agree
  int inliers = 0;                   ///< of these explained by the pose
  double covered_share = 0.0;        ///< of the image, by inliers
  double rms_sigmas = 0.0;           ///< of the inliers' residuals
  double mahalanobis_squared = 0.0;  ///< of the pose, relative to its prediction, 6 degrees of freedom
  /// Pose of the new body in the old body, with the covariance of [dp, dtheta] in axes of the old body:
  /// true = (exp(dtheta) R, p + dp).
  Rigid3 old_from_new;
  Mat6 covariance = Mat6::Identity();
  std::vector<FeatureMatch> inlier_matches;
  std::optional<FieldAgreement> field;  ///< where the field varies; the map's file does not keep it
};

}  // namespace lodeline

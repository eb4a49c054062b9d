#pragma once

#include <vector>

#include "lodeline/estimate.h"
#include "lodeline/mapping/keyframe/map_keyframe.h"
#include "lodeline/types.h"

namespace lodeline {

/// A point of a surface, in the frame F of its cloud.
struct CloudPoint {
  Vec3 position_F = Vec3::Zero();    ///< m
  Mat3 covariance_F = Mat3::Zero();  ///< of that position by its own observation, m^2
  Vec3 view_F = Vec3::Zero();        ///< from the camera that saw it to the point, m
  int observations = 1;              ///< keyframes, or images, in which the point was observed
  TrackId track = -1;                ///< -1 where unknown
  Vec3 normal_F = Vec3::Zero();      ///< unit, towards the camera; zero where neighbours form no plane
  double thickness_m = 0.0;          ///< rms distance of the neighbours from their plane
  double tilt_sigma_rad = 0.0;       ///< of the normal, from thickness, number and spread of the neighbours
};

/// Points of the walls along a few metres of path. Its frame F is the body frame of the keyframe in the
/// middle of that path; the odometry between the keyframes of the stretch joins their points.
struct LocalCloud {
  KeyframeId keyframe = -1;   ///< the one in the middle
  Rigid3 odom_from_frame;     ///< its pose by odometry
  Vec3 up_F = Vec3::UnitZ();  ///< vertical, unit
  std::vector<CloudPoint> points;
};

struct LocalCloudOptions {
  /// Points within this distance of the middle keyframe belong to the cloud. Twice the radius of a usual
  /// passage: walls on all sides and their course over several metres.
  double radius_m = 4.0;
  /// Keyframes up to this far along the path see points of the cloud.
  double path_half_m = 9.0;
  double max_sigma_m = 0.3;  ///< points with a larger standard deviation along the ray say nothing of shape
  double voxel_m = 0.1;      ///< at most one point in a cube of this edge
  /// Relative sigma of the distance of a landmark of a run per metre: 0.005 d^2, a disparity error of 0.3 px
  /// with 400 px of focal length and a baseline of 0.15 m.
  double landmark_sigma_per_m = 0.005;
  int neighbours = 10;  ///< that form the plane of a point; must exceed the three parameters of a plane

  /// Throws UsageError for values that make no sense.
  void check() const;
};

/// Collects the features with a position of the keyframes around `keyframes[middle]`. The keyframes are those
/// of one dive in their order. A track that several keyframes observe becomes one point, the one with the
/// least uncertainty: its errors in neighbouring keyframes are not independent. Throws UsageError for a
/// wrong index and InputError for a pose or a point that is not finite.
LocalCloud cloudOfKeyframes(const std::vector<MapKeyframe>& keyframes, size_t middle,
                            const LocalCloudOptions& options = {});

/// A landmark of a run and the place from which it was seen, both in the world of the run.
struct SeenLandmark {
  MapLandmark landmark;
  Vec3 seen_from = Vec3::Zero();
};

/// The same from landmarks of a run around the pose `world_from_frame`. Landmarks with fewer than three
/// observations are left out.
LocalCloud cloudOfLandmarks(const std::vector<SeenLandmark>& landmarks, KeyframeId keyframe,
                            const Rigid3& world_from_frame, const LocalCloudOptions& options = {});

/// Removes what is isolated, thins what is dense and gives each point a normal. cloudOf... do that.
void finishCloud(LocalCloud& cloud, const LocalCloudOptions& options);

}  // namespace lodeline

#pragma once

#include <memory>

#include "lodeline/cameras/camera.h"
#include "lodeline/frontend/stereo/stereo_delay.h"
#include "lodeline/frontend/stereo/stereo_rotation.h"
#include "lodeline/frontend/tracking/match_quality.h"
#include "lodeline/frontend/tracking/track.h"
#include "lodeline/util/angles.h"

namespace lodeline {

struct StereoMatcherOptions {
  MatchQuality quality;
  int coarsest_level = 3;
  double min_depth_m = 0.2;
  /// Limit for a match; a quarter of a degree where that is more, because errors of the intrinsics grow with
  /// it.
  double max_epipolar_px = 2.0;
  /// Whether the rotation of a camera relative to its file is estimated (StereoRotation), up to
  /// `max_rotation_rad`.
  bool learn_rotation = true;
  double max_rotation_rad = 1.5 * kDegree;
  double max_left_right_px = 0.7;
  double border_px = 8.0;
};

/// Motion of the rig while its cameras take their images, body axes.
struct RigMotion {
  /// Per camera, transformation from the body at the time of its image to the body at the frame's time; empty
  /// where all images were taken at the frame's time.
  std::vector<Rigid3> frame_from_image_B = {};
  Vec3 rate_B = Vec3::Zero();      ///< rad/s
  Vec3 velocity_B = Vec3::Zero();  ///< m/s
};

/// Pair of the rays of two pixels.
inline RayPair rayPair(const ViewRay& first, const ViewRay& second) {
  const ViewRay near_first = first.fromNearestPoint(), near_second = second.fromNearestPoint();
  return {first.direction_C, second.direction_C, near_first.origin_C, near_second.origin_C};
}

/// A patch match in another camera, not yet checked against the epipolar geometry.
struct StereoCandidate {
  PatchWarp warp;
  RayPair rays;
};

/// Matches points of camera 0 in an image that a secondary camera took at the same or nearly the same time;
/// the camera's motion up to the frame's time is compensated. A patch match is a candidate. All candidates of
/// a frame together give the rotation of the camera relative to its file, and this decides which of them are
/// matches.
class StereoMatcher {
 public:
  StereoMatcher(std::shared_ptr<const Camera> first, std::shared_ptr<const Camera> second,
                const StereoMatcherOptions& options);

  /// Sets the rig's motion between the two images; to be called before a frame's points are matched.
  void setMotion(const RigMotion& motion, size_t camera);
  /// Searches for `track.current` at `track.inverse_depth_per_m` or, where that is unknown, anywhere between
  /// `min_depth_m` and infinity; `hint` is the match in the previous images.
  std::optional<StereoCandidate> find(const ImagePyramid& first, const ImagePyramid& second,
                                      const std::optional<PatchWarp>& hint, const Track& track) const;
  /// Updates the rotation with all candidates of a frame.
  void learn(const std::vector<RayPair>& candidates);
  /// Inverse depth (1/m along the first camera's ray, not negative) of a candidate on its epipolar line,
  /// neither too near nor beyond infinity; empty for others.
  std::optional<double> accept(const RayPair& candidate) const;

  /// Ray of the second camera at the frame's time, for a point that it observed on `second` at another time.
  /// The point is at `inverse_depth_per_m` on the ray `first`. It has the origin of `second`.
  Vec3 rayAtFrame(const RayPair& rays, double inverse_depth_per_m) const;

  /// Estimator of the second camera's delay relative to the assumed time.
  StereoDelay& delay() { return delay_; }

  /// Rotation phi (rad, axes of the first camera) of the second camera relative to its file:
  /// first_from_second is exp(phi) times the file's. Zero unless a deviation was found.
  Vec3 rotationCorrection() const;

 private:
  /// Extrinsics of the file, at the times of the images.
  Rigid3 imageSecondFromFirst() const;
  void place();
  /// Distance of a candidate from the epipolar plane, px of the second camera.
  double epipolarErrorPx(const RayPair& rays) const;
  std::optional<Vec2> projectAt(const ViewRay& first, double inverse_depth_per_m) const;
  std::optional<PatchWarp> search(const ImagePyramid& second, const ViewRay& first,
                                  const PatchTemplate& looks) const;
  /// Searches for `looks` from the fine levels if it `is_near` the expected position, and from level
  /// `coarsest` where that fails.
  std::optional<PatchWarp> align(const ImagePyramid& second, const PatchTemplate& looks,
                                 const PatchWarp& expected, bool is_near, int coarsest) const;
  std::optional<double> inverseDepth(const RayPair& rays) const;
  bool returns(const ImagePyramid& first, const ImagePyramid& second, const PatchWarp& match,
               const Track& track) const;

  std::shared_ptr<const Camera> first_, second_;
  StereoMatcherOptions options_;
  double focal_length_px_;  ///< of the second camera, on the axis
  double limit_px_;         ///< max_epipolar_px, or a quarter of a degree
  StereoRotation rotation_;
  StereoDelay delay_;
  Rigid3 second_from_first_by_file_;
  std::optional<Rigid3> frame_from_image_C_;  ///< of the second camera, if its image is of another time
  Vec3 rate_C_ = Vec3::Zero(), velocity_C_ = Vec3::Zero();  ///< of the second camera
  Rigid3 second_from_first_;  ///< at the times of their images, with the estimated rotation
};

}  // namespace lodeline

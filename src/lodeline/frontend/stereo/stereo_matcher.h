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
  /// Of a match; a quarter of a degree where that is more, for what is wrong with a lens grows with it.
  double max_epipolar_px = 2.0;
  /// Learn how a camera is turned against its file (StereoRotation), up to so much.
  bool learn_rotation = true;
  double max_rotation_rad = 1.5 * kDegree;
  double max_left_right_px = 0.7;
  double border_px = 8.0;
};

/// How the rig moves while its cameras take their images, body axes.
struct RigMotion {
  /// Per camera, from the body at the time of its image to the body at the frame's time; empty where all
  /// images were taken at the frame's time.
  std::vector<Rigid3> frame_from_image_B = {};
  Vec3 rate_B = Vec3::Zero();      ///< rad/s
  Vec3 velocity_B = Vec3::Zero();  ///< m/s
};

/// A point found in another camera by its looks.
struct StereoCandidate {
  PatchWarp warp;
  RayPair rays;
};

/// Finds points of camera 0 in the image that another camera of the rig took at the same time, or nearly: its
/// own motion up to the frame's time is taken into account. What is found by
/// its looks is a candidate; all candidates of a frame together tell how the camera is turned against its
/// file, and then which of them are matches.
class StereoMatcher {
 public:
  StereoMatcher(std::shared_ptr<const Camera> first, std::shared_ptr<const Camera> second,
                const StereoMatcherOptions& options);

  /// The rig's motion between the two images; before a frame's matches are looked for.
  void setMotion(const RigMotion& motion, size_t camera);
  /// Looks for `track.current`, expected at `track.inverse_depth_per_m` or, where that is unknown, anywhere
  /// between `min_depth_m` and infinity; `hint` is the match in the images before.
  std::optional<StereoCandidate> find(const ImagePyramid& first, const ImagePyramid& second,
                                      const std::optional<PatchWarp>& hint, const Track& track) const;
  /// All that were found in a frame.
  void learn(const std::vector<RayPair>& candidates);
  /// The inverse depth (1/m along the first camera's ray, not below zero) of a candidate that lies on its
  /// epipolar line and neither too near nor beyond infinity.
  std::optional<double> accept(const RayPair& candidate) const;

  /// The ray that the second camera would have seen at the frame's time, of a point it saw on `second` at its
  /// own time and that lies at `inverse_depth_per_m` on the ray `first`.
  Vec3 rayAtFrame(const RayPair& rays, double inverse_depth_per_m) const;

  /// By how much later than thought the second camera takes its images.
  StereoDelay& delay() { return delay_; }

  /// Rotation phi (rad, axes of the first camera) by which the second one is turned against its file:
  /// first_from_second is exp(phi) times the file's. Zero where nothing speaks against that.
  Vec3 rotationCorrection() const;

 private:
  /// By file, at the times of their images.
  Rigid3 imageSecondFromFirst() const;
  void place();
  /// Distance of a candidate from the epipolar plane, px of the second camera.
  double epipolarErrorPx(const RayPair& rays) const;
  std::optional<Vec2> projectAt(const Vec3& first_bearing, double inverse_depth_per_m) const;
  std::optional<PatchWarp> search(const ImagePyramid& second, const Vec3& first_bearing,
                                  const PatchTemplate& looks) const;
  /// Finds `looks` from the fine levels where it `is_near` what is expected, and from level `coarsest` where
  /// that fails.
  std::optional<PatchWarp> align(const ImagePyramid& second, const PatchTemplate& looks,
                                 const PatchWarp& expected, bool is_near, int coarsest) const;
  std::optional<double> inverseDepth(const RayPair& rays) const;
  bool returns(const ImagePyramid& first, const ImagePyramid& second, const PatchWarp& match,
               const Track& track) const;

  std::shared_ptr<const Camera> first_, second_;
  StereoMatcherOptions options_;
  double limit_px_;  ///< max_epipolar_px or what takes its place
  StereoRotation rotation_;
  StereoDelay delay_;
  Rigid3 second_from_first_by_file_;
  std::optional<Rigid3> frame_from_image_C_;  ///< of the second camera, where its image is of another moment
  Vec3 rate_C_ = Vec3::Zero(), velocity_C_ = Vec3::Zero();  ///< of the second camera
  Rigid3 second_from_first_;  ///< at the times of their images, with the turn found
};

}  // namespace lodeline

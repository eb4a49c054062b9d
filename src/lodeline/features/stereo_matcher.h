#pragma once

#include <memory>

#include "lodeline/cameras/camera.h"
#include "lodeline/features/match_quality.h"
#include "lodeline/features/track.h"

namespace lodeline {

struct StereoMatcherOptions {
  MatchQuality quality;
  int coarsest_level = 3;
  double min_depth_m = 0.2;
  double max_epipolar_px = 2.0;
  double max_left_right_px = 0.7;
  double border_px = 8.0;
};

/// Finds points of camera 0 in the image another camera of the rig took at the same time.
class StereoMatcher {
 public:
  StereoMatcher(std::shared_ptr<const Camera> first, std::shared_ptr<const Camera> second,
                const StereoMatcherOptions& options);

  /// Matches `track.current`, expected at `track.inverse_depth_per_m` or, where that is unknown, anywhere
  /// between `min_depth_m` and infinity. On success sets the inverse depth and returns the place; `hint` is
  /// the match in the images before.
  std::optional<PatchWarp> match(const ImagePyramid& first, const ImagePyramid& second,
                                 const std::optional<PatchWarp>& hint, Track& track) const;

  /// Distance of a match from the epipolar plane, px of the second camera.
  double epipolarErrorPx(const Vec3& first_bearing, const Vec3& second_bearing) const;

 private:
  std::optional<Vec2> projectAt(const Vec3& first_bearing, double inverse_depth_per_m) const;
  std::optional<PatchWarp> search(const ImagePyramid& second, const Vec3& first_bearing,
                                  const PatchTemplate& looks) const;
  std::optional<double> inverseDepth(const Vec3& first_bearing, const Vec3& second_bearing) const;
  bool returns(const ImagePyramid& first, const ImagePyramid& second, const PatchWarp& match,
               const Track& track) const;

  std::shared_ptr<const Camera> first_, second_;
  Rigid3 second_from_first_;
  StereoMatcherOptions options_;
};

}  // namespace lodeline

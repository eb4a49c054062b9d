#pragma once

#include <memory>

#include "lodeline/cameras/camera.h"
#include "lodeline/frontend/tracking/match_quality.h"
#include "lodeline/frontend/tracking/track.h"

namespace lodeline {

struct TemporalTrackerOptions {
  /// For the comparison with the image before.
  MatchQuality quality{.min_correlation = 0.7};
  /// For the comparison with the first observation, in which the point may have looked different.
  MatchQuality reference_quality{.min_correlation = 0.9};
  int coarsest_level = 3;
  double max_forward_backward_px = 1.0;
  double border_px = 8.0;
};

/// Tracks points from one image of a camera to the next.
class TemporalTracker {
 public:
  TemporalTracker(std::shared_ptr<const Camera> camera, const TemporalTrackerOptions& options)
      : camera_(std::move(camera)), options_(options) {}

  /// Moves `track` into the current image; returns false where it is not found there, `track` is then
  /// unspecified. `current_from_previous_C`: rotation of the camera between the images. Sets `track.current`.
  bool follow(const ImagePyramid& previous, const ImagePyramid& current, const Mat3& current_from_previous_C,
              Track& track) const;

  /// Prediction of a patch by the rotation alone, including its in-plane rotation and distortion.
  std::optional<PatchWarp> predict(const Mat3& current_from_previous_C, const PatchWarp& warp) const;

 private:
  bool find(const ImagePyramid& current, const PatchWarp& predicted, Track& track) const;
  bool findFrom(int coarsest, const ImagePyramid& current, const PatchWarp& predicted, Track& track) const;
  bool returns(const ImagePyramid& previous, const PatchWarp& predicted,
               const Eigen::Vector2f& previous_position, const Track& track) const;

  std::shared_ptr<const Camera> camera_;
  TemporalTrackerOptions options_;
};

}  // namespace lodeline

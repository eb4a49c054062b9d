#pragma once

#include <opencv2/core/mat.hpp>

#include "lodeline/mapping/recognition/frame_geometry.h"

namespace lodeline {

struct KeyframeDescriberOptions {
  /// Features of a keyframe: tracked points, then further corners up to this number.
  int features = 400;
  /// Standard deviation of a corner that was not tracked, px.
  double corner_sigma_px = 1.5;

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

/// Makes the keyframe of a map from one frame: tracked points and further corners of camera 0, their
/// descriptors, rays and positions.
///
/// Tracked points alone do not repeat: which corners are tracked depends on the way to the place. The further
/// corners come from the detector that starts tracks. They therefore include most of the points that another
/// visit tracks. Descriptors are the 256 comparisons of ORB (Rublee et al., "ORB: an efficient alternative to
/// SIFT or SURF", ICCV 2011). They are oriented by the projected vertical, which does not depend on noise.
/// Where a ray is nearly vertical, the intensity centroid orients them.
class KeyframeDescriber {
 public:
  /// Throws InputError where a camera cannot be used, UsageError where an option is out of its range.
  KeyframeDescriber(const Rig& rig, const KeyframeDescriberOptions& options = {});

  /// The keyframe of the estimator's newest frame. `image`: of camera 0, 8-bit grey. `tracks` and `estimate`
  /// are of that frame. `visible`: 8-bit, zero where the rig itself covers the view
  /// (FrontEnd::fixedStructures()); empty for nothing but the mask of the calibration. Id and dive are left
  /// to the map. Throws InputError where the image is not that of the calibration.
  MapKeyframe describe(const std::vector<cv::Mat>& images, const FrameTracks& tracks, const FrameEstimate& estimate,
                       const Estimator& estimator, const cv::Mat& visible = {}) const;
  /// The same with a given geometry.
  MapKeyframe describe(const std::vector<cv::Mat>& images, const FrameTracks& tracks, const FrameEstimate& estimate,
                       const FrameGeometry& geometry, const cv::Mat& visible = {}) const;

  const std::vector<std::shared_ptr<const Camera>>& cameras() const { return cameras_; }

 private:
  KeyframeDescriberOptions options_;
  std::vector<std::shared_ptr<const Camera>> cameras_;
  cv::Mat mask_;  ///< of camera 0, by its calibration
};

}  // namespace lodeline

#pragma once

#include <opencv2/core/mat.hpp>

#include "lodeline/mapping/recognition/frame_geometry.h"

namespace lodeline {

struct KeyframeDescriberOptions {
  /// Largest number of features of a keyframe, and of blobs that are detected.
  int features = 360;
  /// Standard deviation of a blob along each axis, px of the evened image.
  double blob_sigma_px = 0.6;

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

/// The values of a keyframe beside its features and its field: time, odometry, heading and depth.
MapKeyframe keyframeOf(const FrameEstimate& estimate);

/// Makes the keyframe of a map from one frame: tracked points and blobs of camera 0, their descriptors, rays
/// and positions.
///
/// Tracked points alone do not repeat: which corners are tracked depends on the way to the place. Blobs
/// depend on the rock alone (keypoints/blob_detector.h). Descriptors are of the evened image
/// (keypoints/evened_image.h), in patches of one size on the rock. They are oriented by the projected
/// vertical, which does not depend on noise. Where a ray is nearly vertical, the intensity centroid orients
/// them.
class KeyframeDescriber {
 public:
  /// Throws InputError where a camera cannot be used, UsageError where an option is out of its range.
  KeyframeDescriber(const Rig& rig, const KeyframeDescriberOptions& options = {});

  /// The keyframe of the estimator's newest frame. `images`: of each camera, 8-bit grey, taken at one time;
  /// further cameras without such an image have an empty one. `tracks` and `estimate` are of that frame.
  /// `visible`: 8-bit, zero where the rig itself covers the view (FrontEnd::fixedStructures()); empty for
  /// nothing but the mask of the calibration. Id and dive are left to the map. Throws InputError where the
  /// image is not that of the calibration.
  MapKeyframe describe(const std::vector<cv::Mat>& images, const FrameTracks& tracks,
                       const FrameEstimate& estimate, const Estimator& estimator,
                       const cv::Mat& visible = {}) const;
  /// The same with a given geometry.
  MapKeyframe describe(const std::vector<cv::Mat>& images, const FrameTracks& tracks,
                       const FrameEstimate& estimate, const FrameGeometry& geometry,
                       const cv::Mat& visible = {}) const;

  const std::vector<std::shared_ptr<const Camera>>& cameras() const { return cameras_; }

 private:
  KeyframeDescriberOptions options_;
  std::vector<std::shared_ptr<const Camera>> cameras_;
  cv::Mat mask_;  ///< of camera 0, by its calibration
};

}  // namespace lodeline

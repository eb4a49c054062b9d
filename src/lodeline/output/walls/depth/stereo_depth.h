#pragma once

#include <opencv2/calib3d.hpp>

#include "lodeline/output/walls/depth/depth_image.h"

namespace lodeline {

/// Depths of the first camera of a rectified pair by semi-global matching (H. Hirschmüller, "Stereo
/// processing by semiglobal matching and mutual information", PAMI 2008, in OpenCV's implementation). A depth
/// is kept where the match leads back to it, the surface has texture and the region is no speck. The expected
/// error, |dz/dd| times the sigma of a match, must be small enough.
class StereoDepth {
 public:
  /// Keeps a reference to `view`, which has two cameras.
  StereoDepth(const RectifiedView& view, const DepthImageOptions& options);

  /// `first`, `second`: rectified 8-bit grey images. The result has no colour.
  DepthImage compute(const cv::Mat& first, const cv::Mat& second) const;

 private:
  const RectifiedView& view_;
  DepthImageOptions options_;
};

}  // namespace lodeline

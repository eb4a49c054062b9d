#pragma once

#include <functional>
#include <opencv2/core.hpp>

#include "simulation/rendering/optics/camera_optics.h"

namespace lodeline {

/// Movement of the camera during the exposure of one image.
struct ExposureMotion {
  Rigid3 start_from_middle;  ///< camera frame at the start of the exposure from that at its middle
  Rigid3 end_from_middle;
  double exposure_s = 0.0;
};

/// Averages light along each pixel's path in the image during the exposure. The static point at a pixel (its
/// ray at range `range_m`) is projected at start and end. The radiance is averaged along the line between.
/// This is exact for points that are not occluded in between. Both images are CV_32F.
void blurByMotion(cv::Mat& radiance, const cv::Mat& range_m, const CameraOptics& optics,
                  const ExposureMotion& motion);

}  // namespace lodeline

#pragma once

#include <functional>
#include <opencv2/core.hpp>

#include "simulation/rendering/optics/camera_optics.h"

namespace lodeline {

/// Movement of the camera during the exposure of one image.
struct ExposureMotion {
  Rigid3 start_from_middle;  ///< camera frame at the exposure's begin from that at its middle
  Rigid3 end_from_middle;
};

/// Spreads light along each pixel's own path over the image during the exposure: the standing point seen by
/// the pixel (its ray at range `range_m`) is projected at begin and end, and radiance is averaged along the
/// line between. Exact for points that nothing covers in the meantime. Both images CV_32F.
void blurByMotion(cv::Mat& radiance, const cv::Mat& range_m, const CameraOptics& optics,
                  const ExposureMotion& motion);

}  // namespace lodeline

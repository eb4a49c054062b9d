#pragma once

#include <vector>

#include "lodeline/mapping/recognition/frame_geometry.h"

namespace lodeline {

/// A ray of camera 0 with the distance at which its point is expected.
struct ExpectedPoint {
  BodyRay ray;
  double distance_m = 2.0;
};

/// Rays of a further camera to points of camera 0, from images of one time; empty where none is found.
///
/// The patch around the pixel is aligned in the further image, from the expected distance and from nearer and
/// farther ones. The result must lead back to the pixel, and lie on the epipolar plane within three sigma.
/// `first`, `further`: 8-bit grey, of camera 0 and of `camera`. `sigma_px`: of the pixels.
std::vector<std::optional<BodyRay>> raysOfFurtherCamera(const cv::Mat& first, const cv::Mat& further,
                                                        int camera, const FrameGeometry& geometry,
                                                        const std::vector<ExpectedPoint>& points,
                                                        double sigma_px);

}  // namespace lodeline

#pragma once

#include <vector>

#include "lodeline/mapping/recognition/frame_geometry.h"

namespace lodeline {

/// Rays of a second camera to points of the first one, from images of one time. Empty where none is found.
/// `depths_m`: expected distance of each point. A patch is aligned in the second image from there; it must lead
/// back, and lie on the epipolar plane.
std::vector<std::optional<BodyRay>> secondRays(const cv::Mat& first, const cv::Mat& second, int camera,
                                               const FrameGeometry& geometry, const std::vector<BodyRay>& rays,
                                               const std::vector<double>& distances_m, double sigma_px);

}  // namespace lodeline

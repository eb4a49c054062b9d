#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "lodeline/types.h"

namespace lodeline {

/// The saddle point near `start`, to a fraction of a pixel: the point to which all gradients around it are
/// orthogonal (W. Förstner, E. Gülch, "A fast operator for detection and precise location of distinct
/// points", 1987). `gap_px` is the least width of the fields that meet there. Nothing where the point leaves
/// its neighbourhood, or is too close to the border of the image.
std::optional<Vec2> refinedCorner(const cv::Mat& image, const Vec2& start, double gap_px);

}  // namespace lodeline

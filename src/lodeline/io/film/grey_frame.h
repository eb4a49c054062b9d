#pragma once

#include <opencv2/core/mat.hpp>

struct AVFrame;

namespace lodeline::av {

/// The luminance of a decoded image as 8-bit grey in memory that OpenCV owns. `size`: to scale to; empty for
/// the frame's own. More than 8 bits are shifted to 8. Empty for a pixel format that cannot be converted.
cv::Mat greyFrame(const AVFrame& frame, cv::Size size);

}  // namespace lodeline::av

#pragma once

#include <opencv2/core/mat.hpp>

#include "lodeline/frontend/front_end.h"

namespace lodeline {

/// Draws a colour image (8-bit BGR) of the last frame: the images of all cameras side by side, with the
/// statistics below. Every track is a dot from blue (new) to red (`old_observations` or more), with its
/// matches in the same colour. Static structures are darkened. `images` as given to `FrontEnd::process`, or
/// those of the first cameras alone; a missing image is drawn black.
cv::Mat drawTracks(const FrontEnd& front_end, const std::vector<cv::Mat>& images, int old_observations = 40);

}  // namespace lodeline

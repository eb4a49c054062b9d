#pragma once

#include <opencv2/core/mat.hpp>

#include "lodeline/frontend/front_end.h"

namespace lodeline {

/// A colour picture (8-bit BGR) of the last frame: the images of all cameras side by side, every track a dot
/// from blue (new) to red (`old_observations` or more), with its matches in the same colour and the
/// statistics below; what is fixed in them is darkened. `images` as given to `FrontEnd::process`, or those of
/// the first cameras alone; a missing image is drawn black.
cv::Mat drawTracks(const FrontEnd& front_end, const std::vector<cv::Mat>& images, int old_observations = 40);

}  // namespace lodeline

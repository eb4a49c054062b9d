#pragma once

#include <string>

#include "lodeline/frontend/detection/image_pyramid.h"

namespace lodeline {

/// Statistics of an image's quality.
struct ImageQuality {
  double mean_grey = 0.0;
  double contrast_grey = 0.0;  ///< standard deviation of the image
  /// Mean second difference on the quarter-size image; insensitive to brightness gradients.
  double texture_grey = 0.0;
  double sharpness = 0.0;  ///< share of fine detail: about 0.37 when sharp, 0.25 blurred over ten px
  double saturated = 0.0;  ///< share of pixels at the upper limit
  /// "good", or the problem for tracking: "dark", "overexposed", "textureless", "faint" or "blurred".
  std::string word = "good";
};

ImageQuality assess(const ImagePyramid& image);

}  // namespace lodeline

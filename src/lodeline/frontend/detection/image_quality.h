#pragma once

#include <string>

#include "lodeline/frontend/detection/image_pyramid.h"

namespace lodeline {

/// What can be said of an image at a glance.
struct ImageQuality {
  double mean_grey = 0.0;
  double contrast_grey = 0.0;  ///< standard deviation of the image
  double texture_grey = 0.0;   ///< mean second difference on the quarter-size image, blind to slopes of light
  double sharpness = 0.0;      ///< share of fine detail: about 0.37 when sharp, 0.25 blurred over ten px
  double saturated = 0.0;      ///< share of pixels at the upper end
  /// "good", or what hinders tracking: "dark", "overexposed", "textureless", "faint" or "blurred".
  std::string word = "good";
};

ImageQuality assess(const ImagePyramid& image);

}  // namespace lodeline

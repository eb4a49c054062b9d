#include "lodeline/frontend/detection/mask.h"

#include <fmt/format.h>

#include <opencv2/imgcodecs.hpp>

#include "lodeline/diagnostics.h"

namespace lodeline {

cv::Mat loadMask(const CameraCalibration& calibration) {
  const CameraCalibration& c = calibration;
  if (c.mask_file.empty()) return {};
  cv::Mat mask = cv::imread(c.mask_file, cv::IMREAD_GRAYSCALE);
  if (mask.empty()) {
    throw InputError(
        fmt::format("camera '{}': mask '{}' cannot be read as an image; correct its path or leave it out of "
                    "the calibration",
                    c.name, c.mask_file));
  }
  if (mask.cols != c.width_px || mask.rows != c.height_px) {
    throw InputError(fmt::format("camera '{}': mask '{}' is {} x {} px, the camera's images are {} x {} px",
                                 c.name, c.mask_file, mask.cols, mask.rows, c.width_px, c.height_px));
  }
  return mask;
}

}  // namespace lodeline

#pragma once

#include <cstdint>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"

namespace lodeline {

/// Conversion of a camera's 16-bit pixels to 8-bit grey: (value - low) / 2^shift, clipped to 0 and 255. All
/// images of a camera use one range, so that their grey values stay comparable.
struct GreyRange {
  uint16_t low = 0;
  int shift = 8;

  uint8_t grey(uint16_t value) const {
    const int level = value <= low ? 0 : (value - low) >> shift;
    return static_cast<uint8_t>(level > 255 ? 255 : level);
  }
};

/// Measures the range used by 16-bit images: the fewest of 8, 10, 12, 14 and 16 bits that contain all but a
/// thousandth of the pixels (dead pixels). The pixels of thermal cameras start at three quarters of the
/// largest value or higher. The range then is their span, extended by half of it on both sides. Images of
/// other depths are ignored. Returns nothing where there is no 16-bit image.
std::optional<GreyRange> measureGreyRange(const std::vector<cv::Mat>& images);

/// Measures the range on at most eight images spread over a recording. `image` returns the stored pixels of
/// an image by number, empty where there are none. Where the first readable image has 8 bits, no other is
/// read.
std::optional<GreyRange> measureGreyRange(size_t count, const std::function<cv::Mat(size_t)>& image);

/// Reports a notice where a camera's 16-bit images use a range other than the full 16 bits.
void reportGreyRange(const std::string& camera, const std::optional<GreyRange>& range,
                     Diagnostics* diagnostics);

}  // namespace lodeline

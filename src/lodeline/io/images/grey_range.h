#pragma once

#include <cstdint>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// How the 16-bit pixels of a camera become 8-bit grey: (value - low) / 2^shift, cut off at 0 and 255. One
/// range for all images of a camera, so that their grey values stay comparable.
struct GreyRange {
  uint16_t low = 0;
  int shift = 8;

  uint8_t grey(uint16_t value) const {
    const int level = value <= low ? 0 : (value - low) >> shift;
    return static_cast<uint8_t>(level > 255 ? 255 : level);
  }
};

/// The range that 16-bit images use: the fewest of 8, 10, 12, 14 and 16 bits that hold all but a thousandth
/// of the pixels (dead pixels). Where the pixels begin at three quarters of the greatest and higher, as those
/// of thermal cameras do, the span between them and half of that on both sides. Images of other depths do not
/// count; nothing where there is no 16-bit image.
std::optional<GreyRange> measureGreyRange(const std::vector<cv::Mat>& images);

/// The same of the images of a recording, at most eight of them, spread over it. `image`: pixels as stored,
/// by number, empty where there are none. No more than the first readable image is looked at where that has 8
/// bits.
std::optional<GreyRange> measureGreyRange(size_t count, const std::function<cv::Mat(size_t)>& image);

/// Says, as a notice, where a camera's 16-bit images use another range than all of the 16 bits.
void reportGreyRange(const std::string& camera, const std::optional<GreyRange>& range,
                     Diagnostics* diagnostics);

}  // namespace lodeline

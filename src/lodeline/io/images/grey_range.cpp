#include "lodeline/io/images/grey_range.h"

#include <fmt/core.h>

#include <algorithm>

namespace lodeline {

std::optional<GreyRange> measureGreyRange(const std::vector<cv::Mat>& images) {
  std::vector<uint16_t> values;
  for (const cv::Mat& image : images) {
    if (image.depth() != CV_16U) continue;
    const int of_row = image.cols * image.channels();
    for (int row = 0; row < image.rows; ++row) {
      values.insert(values.end(), image.ptr<uint16_t>(row), image.ptr<uint16_t>(row) + of_row);
    }
  }
  if (values.empty()) return std::nullopt;
  const auto least = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 1000);
  std::nth_element(values.begin(), least, values.end());
  const int low = *least;
  const auto greatest = values.end() - 1 - static_cast<std::ptrdiff_t>(values.size() / 1000);
  std::nth_element(values.begin(), greatest, values.end());
  const int high = *greatest;

  const auto shiftFor = [](int span) {
    int shift = 0;
    while (span >> shift > 255) ++shift;
    return shift;
  };
  if (high > 1023 && low > high - high / 4) {
    const int margin = (high - low) / 2 + 1;
    const int from = std::max(0, low - margin);
    return GreyRange{static_cast<uint16_t>(from), shiftFor(high + margin - from)};
  }
  // Cameras have 8, 10, 12, 14 or 16 bits; dark images may use the remaining bits later.
  const int shift = shiftFor(high);
  return GreyRange{0, shift + shift % 2};
}

std::optional<GreyRange> measureGreyRange(size_t count, const std::function<cv::Mat(size_t)>& image) {
  constexpr size_t kMost = 8;
  std::vector<cv::Mat> images;
  const size_t step = std::max<size_t>(1, count / kMost);
  for (size_t i = 0; i < count && images.size() < kMost; i += step) {
    cv::Mat pixels = image(i);
    if (pixels.empty()) continue;
    if (pixels.depth() != CV_16U && images.empty()) return std::nullopt;
    images.push_back(std::move(pixels));
  }
  return measureGreyRange(images);
}

void reportGreyRange(const std::string& camera, const std::optional<GreyRange>& range,
                     Diagnostics* diagnostics) {
  if (!range || (range->low == 0 && range->shift == 8)) return;
  diagnostics->report(
      Severity::Notice, "image_range",
      fmt::format(
          "{}: 16-bit images that use the values from {} to {}; these are scaled to 8 bits, the same for "
          "all images",
          camera, range->low, range->low + (256 << range->shift) - 1));
}

}  // namespace lodeline

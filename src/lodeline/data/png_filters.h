#pragma once

#include <cstdint>

namespace lodeline::png {

/// The Paeth predictor: whichever of left, up and up-left is nearest to left + up - up_left, in this order
/// among equals; of integers, or of vectors of them element by element. Written with comparisons of left and
/// up against 3 up_left - left - up instead of three absolute differences, which compiles without branches;
/// the test compares it with the definition for all arguments.
template <typename T>
T paeth(T left, T up, T up_left) {
  const T threshold = 3 * up_left - left - up;
  const T low = left < up ? left : up;
  const T high = left < up ? up : left;
  const T upper = high <= threshold ? low : up_left;
  return threshold <= low ? high : upper;
}

/// Undoes the filters of an image of one byte per pixel. `filtered` holds `height` rows of a filter type and
/// `width` bytes each; `pixels` receives height x width bytes without padding. False for an unknown filter.
bool unfilter(const uint8_t* filtered, int width, int height, uint8_t* pixels);

}  // namespace lodeline::png

#pragma once

#include <cstdint>

namespace lodeline::png {

/// The Paeth predictor: whichever of left, up and up-left is nearest to left + up - up_left, in this order
/// among equals; of unsigned bytes, or of vectors of them element by element. That point is as far from left
/// as up is from up-left, and the other way round; up-left can only be nearer where it lies between the two.
/// The test compares this with the definition for all arguments.
template <typename T>
T paeth(T left, T up, T up_left) {
  const T to_left = up < up_left ? up_left - up : up - up_left;
  const T to_up = left < up_left ? up_left - left : left - up_left;
  const T nearer = to_left <= to_up ? left : up;
  const T less = to_left < to_up ? to_left : to_up;
  const T more = to_left < to_up ? to_up : to_left;
  const auto is_between = (left < up_left) != (up < up_left);
  return (is_between & (more - less < less)) ? up_left : nearer;
}

/// Undoes the filters of an image of one byte per pixel. `filtered` holds `height` rows of a filter type and
/// `width` bytes each; `pixels` receives height x width bytes without padding. False for an unknown filter.
bool unfilter(const uint8_t* filtered, int width, int height, uint8_t* pixels);

}  // namespace lodeline::png

#pragma once

#include <cstdint>

namespace lodeline::png {

/// The Paeth predictor: the value among left, up and up-left that is nearest to left + up - up_left, in this
/// order for equal distances. Arguments are unsigned bytes or vectors of them, element by element. The
/// distance to left is |up - up_left|, and the distance to up is |left - up_left|. Up-left can be the nearest
/// only where its value is between the other two. The test compares this with the definition for all
/// arguments.
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

/// Undoes the filters of an image with one byte per pixel. `filtered` holds `height` rows, each with a filter
/// type and `width` bytes. `pixels` receives height x width bytes without padding. Returns false for an
/// unknown filter.
bool unfilter(const uint8_t* filtered, int width, int height, uint8_t* pixels);

}  // namespace lodeline::png

#include "lodeline/data/png_filters.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <vector>

namespace lodeline::png {
namespace {

enum Filter : uint8_t { kNone = 0, kSub = 1, kUp = 2, kAverage = 3, kPaeth = 4 };

constexpr int kLanes = 8;
using Short8 = int16_t __attribute__((vector_size(2 * kLanes)));

void unfilterRow(uint8_t filter, const uint8_t* filtered, const uint8_t* above, int width, uint8_t* row) {
  uint8_t left = 0, up_left = 0;
  switch (filter) {
    case kNone:
      std::memcpy(row, filtered, static_cast<size_t>(width));
      return;
    case kSub:
      for (int x = 0; x < width; ++x) row[x] = left = static_cast<uint8_t>(filtered[x] + left);
      return;
    case kUp:
      for (int x = 0; x < width; ++x) row[x] = static_cast<uint8_t>(filtered[x] + above[x]);
      return;
    case kAverage:
      for (int x = 0; x < width; ++x)
        row[x] = left = static_cast<uint8_t>(filtered[x] + (left + above[x]) / 2);
      return;
    default:
      for (int x = 0; x < width; ++x) {
        row[x] = left = static_cast<uint8_t>(filtered[x] + paeth<int>(left, above[x], up_left));
        up_left = above[x];
      }
  }
}

/// Whether rows are quicker abreast than one by one: Paeth alone is slow enough.
bool payAbreast(const uint8_t* filtered, int width, int rows) {
  constexpr int kFewest = 3;
  int slow = 0;
  for (int r = 0; r < rows; ++r) slow += filtered[r * (width + 1)] == kPaeth;
  return filtered[0] == kPaeth && slow >= kFewest;
}

/// Paeth makes each pixel wait for its left neighbour, so a row alone leaves the processor idle. Here eight
/// rows go abreast, one to a lane, each a pixel behind the row above it.
class RowsAbreast {
 public:
  explicit RowsAbreast(int width) : width_(width), steps_(static_cast<size_t>(width + kLanes - 1)) {}

  /// Any filters; `rows` may be fewer than lanes.
  void unfilter(const uint8_t* filtered, const uint8_t* above, int rows, uint8_t* pixels) {
    load(filtered, rows);
    Short8 left{}, up_left{};
    for (size_t k = 0; k < steps_.size(); ++k) {
      // Lanes that have not come to their row yet see zeros all around and stay zero.
      Short8 up = __builtin_shuffle(left, Short8{0, 0, 1, 2, 3, 4, 5, 6});
      up[0] = k < static_cast<size_t>(width_) ? above[k] : 0;
      const Short8 predicted = (is_[kSub] & left) | (is_[kUp] & up) | (is_[kAverage] & ((left + up) >> 1)) |
                               (is_[kPaeth] & paeth(left, up, up_left));
      left = (steps_[k] + predicted) & 255;
      up_left = up;
      steps_[k] = left;
    }
    for (int r = 0; r < rows; ++r) {
      uint8_t* row = pixels + r * width_;
      const int16_t* lane = laneOf(r);
      for (int x = 0; x < width_; ++x) row[x] = static_cast<uint8_t>(lane[x * kLanes]);
    }
  }

 private:
  void load(const uint8_t* filtered, int rows) {
    std::fill(steps_.begin(), steps_.end(), Short8{});
    is_ = {};
    for (int r = 0; r < rows; ++r) {
      const uint8_t* row = filtered + r * (width_ + 1);
      is_[row[0]][r] = -1;
      int16_t* lane = laneOf(r);
      for (int x = 0; x < width_; ++x) lane[x * kLanes] = row[x + 1];
    }
  }

  /// Of a row's first pixel; the others follow at a distance of kLanes.
  int16_t* laneOf(int row) { return reinterpret_cast<int16_t*>(&steps_[static_cast<size_t>(row)]) + row; }

  int width_;
  std::vector<Short8> steps_;            ///< first the filtered bytes, then the pixels
  std::array<Short8, kPaeth + 1> is_{};  ///< by filter: all bits set in the lanes that have it
};

}  // namespace

bool unfilter(const uint8_t* filtered, int width, int height, uint8_t* pixels) {
  const ptrdiff_t stride = width + 1;
  for (int y = 0; y < height; ++y) {
    if (filtered[y * stride] > kPaeth) return false;
  }
  const std::vector<uint8_t> black(static_cast<size_t>(width), 0);
  const uint8_t* above = black.data();
  RowsAbreast abreast(width);
  for (int y = 0; y < height;) {
    int rows = std::min(kLanes, height - y);
    if (payAbreast(filtered, width, rows)) {
      abreast.unfilter(filtered, above, rows, pixels);
    } else {
      rows = 1;
      unfilterRow(filtered[0], filtered + 1, above, width, pixels);
    }
    filtered += rows * stride;
    pixels += rows * width;
    y += rows;
    above = pixels - width;
  }
  return true;
}

}  // namespace lodeline::png

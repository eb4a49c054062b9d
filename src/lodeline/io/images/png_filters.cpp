#include "lodeline/io/images/png_filters.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <vector>

#include "lodeline/util/simd_dispatch.h"

namespace lodeline::png {
namespace {

enum Filter : uint8_t { kNone = 0, kSub = 1, kUp = 2, kAverage = 3, kPaeth = 4 };

constexpr size_t kLanes = 16;
using Bytes = uint8_t __attribute__((vector_size(kLanes)));

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

/// Whether parallel rows are faster than single rows; only Average and Paeth are slow enough.
bool payAbreast(const uint8_t* filtered, int width, int rows) {
  constexpr int kFewest = 3;
  int slow = 0;
  for (int r = 0; r < rows; ++r) slow += filtered[r * (width + 1)] >= kAverage;
  return filtered[0] >= kAverage && slow >= kFewest;
}

using Block = std::array<Bytes, kLanes>;

/// Byte j of vector i becomes byte i of vector j: four perfect shuffles of all bytes.
inline __attribute__((always_inline)) void transpose(Block* block) {
  for (int round = 0; round < 4; ++round) {
    const Block from = *block;
    for (size_t i = 0; i < kLanes / 2; ++i) {
      (*block)[2 * i] = __builtin_shufflevector(from[i], from[i + kLanes / 2], 0, 16, 1, 17, 2, 18, 3, 19, 4,
                                                20, 5, 21, 6, 22, 7, 23);
      (*block)[2 * i + 1] = __builtin_shufflevector(from[i], from[i + kLanes / 2], 8, 24, 9, 25, 10, 26, 11,
                                                    27, 12, 28, 13, 29, 14, 30, 15, 31);
    }
  }
}

/// Lane masks by filter: all bits are set in the lanes with that filter.
using Masks = std::array<Bytes, kPaeth + 1>;

/// Prediction of each lane's filter from its neighbours.
template <bool kAnyPaeth>
inline __attribute__((always_inline)) Bytes predicted(const Masks& is, Bytes left, Bytes up, Bytes up_left) {
  const Bytes average = (left & up) + ((left ^ up) >> 1);
  Bytes sum = (is[kSub] & left) | (is[kUp] & up) | (is[kAverage] & average);
  if constexpr (kAnyPaeth) sum |= is[kPaeth] & paeth(left, up, up_left);
  return sum;
}

/// Processes one byte of `above` per step, for `blocks` blocks of bytes. Lane r begins at rows[r].
template <bool kAnyPaeth>
inline __attribute__((always_inline)) void stepAbreast(const Masks& is, const uint8_t* above, size_t blocks,
                                                       const std::array<uint8_t*, kLanes>& rows) {
  Bytes left{}, up_left{};
  for (size_t first = 0; first < blocks * kLanes; first += kLanes) {
    Block block;
    for (size_t r = 0; r < kLanes; ++r) std::memcpy(&block[r], rows[r] + first, kLanes);
    transpose(&block);
    for (size_t i = 0; i < kLanes; ++i) {
      const Bytes up = __builtin_shufflevector(left, Bytes{above[first + i]}, 16, 0, 1, 2, 3, 4, 5, 6, 7, 8,
                                               9, 10, 11, 12, 13, 14);
      left = block[i] + predicted<kAnyPaeth>(is, left, up, up_left);
      up_left = up;
      block[i] = left;
    }
    transpose(&block);
    for (size_t r = 0; r < kLanes; ++r) std::memcpy(rows[r] + first, &block[r], kLanes);
  }
}

LODELINE_WIDE_VECTORS
void stepWithPaeth(const Masks& is, const uint8_t* above, size_t blocks,
                   const std::array<uint8_t*, kLanes>& rows) {
  stepAbreast<true>(is, above, blocks, rows);
}

LODELINE_WIDE_VECTORS
void stepWithoutPaeth(const Masks& is, const uint8_t* above, size_t blocks,
                      const std::array<uint8_t*, kLanes>& rows) {
  stepAbreast<false>(is, above, blocks, rows);
}

/// Unfilters sixteen rows in parallel, one per lane, each lane one pixel behind the row above it. A pixel
/// depends on its left neighbour, so a single row would leave the processor mostly idle.
class RowsAbreast {
 public:
  explicit RowsAbreast(int width)
      : width_(static_cast<size_t>(width)),
        blocks_((width_ + 2 * kLanes - 2) / kLanes),
        above_(blocks_ * kLanes),
        bytes_(kLanes * stride()) {}

  /// Handles any filters; `rows` may be fewer than the lanes.
  void unfilter(const uint8_t* filtered, const uint8_t* above, size_t rows, uint8_t* pixels) {
    // Lanes before the start of their row have zeros as neighbours and stay zero.
    std::fill(bytes_.begin(), bytes_.end(), uint8_t{0});
    std::copy_n(above, width_, above_.begin());
    Masks is{};
    std::array<uint8_t*, kLanes> begins;
    for (size_t r = 0; r < kLanes; ++r) begins[r] = pixelsOf(r) - r;
    bool any_paeth = false;
    for (size_t r = 0; r < rows; ++r) {
      const uint8_t* row = filtered + r * (width_ + 1);
      is[row[0]][r] = 0xff;
      any_paeth |= row[0] == kPaeth;
      std::copy_n(row + 1, width_, pixelsOf(r));
    }
    (any_paeth ? stepWithPaeth : stepWithoutPaeth)(is, above_.data(), blocks_, begins);
    for (size_t r = 0; r < rows; ++r) std::copy_n(pixelsOf(r), width_, pixels + r * width_);
  }

 private:
  size_t stride() const { return (blocks_ + 1) * kLanes; }
  uint8_t* pixelsOf(size_t row) { return bytes_.data() + row * stride() + kLanes; }

  size_t width_, blocks_;
  std::vector<uint8_t> above_;
  std::vector<uint8_t> bytes_;  ///< per lane, with zeros before its row: filtered bytes first, then pixels
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
    int rows = std::min(static_cast<int>(kLanes), height - y);
    if (payAbreast(filtered, width, rows)) {
      abreast.unfilter(filtered, above, static_cast<size_t>(rows), pixels);
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

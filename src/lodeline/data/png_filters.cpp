#include "lodeline/data/png_filters.h"

#include <cstddef>
#include <cstring>
#include <vector>

namespace lodeline::png {
namespace {

enum Filter : uint8_t { kNone = 0, kSub = 1, kUp = 2, kAverage = 3, kPaeth = 4 };

/// Undoes Paeth along one row, a pixel at a time.
class PaethRow {
 public:
  PaethRow(const uint8_t* filtered, uint8_t* row) : filtered_(filtered), row_(row) {}

  void step(int x, int up) {
    left_ = static_cast<uint8_t>(filtered_[x] + paeth(left_, up, up_left_));
    up_left_ = up;
    row_[x] = static_cast<uint8_t>(left_);
  }
  int left() const { return left_; }

 private:
  const uint8_t* filtered_;
  uint8_t* row_;
  int left_ = 0;
  int up_left_ = 0;
};

void unfilterPaeth(const uint8_t* filtered, const uint8_t* above, int width, uint8_t* row) {
  PaethRow paeth_row(filtered, row);
  for (int x = 0; x < width; ++x) paeth_row.step(x, above[x]);
}

/// Each pixel waits for its left neighbour, so a row alone leaves the processor idle; the row below follows
/// one pixel behind and fills the time.
void unfilterPaethPair(const uint8_t* filtered, const uint8_t* above, int width, uint8_t* rows) {
  PaethRow first(filtered, rows);
  PaethRow second(filtered + width + 1, rows + width);
  first.step(0, above[0]);
  for (int x = 1; x < width; ++x) {
    const int up_of_second = first.left();
    first.step(x, above[x]);
    second.step(x - 1, up_of_second);
  }
  second.step(width - 1, first.left());
}

bool unfilterRow(uint8_t filter, const uint8_t* filtered, const uint8_t* above, int width, uint8_t* row) {
  uint8_t left = 0;
  switch (filter) {
    case kNone:
      std::memcpy(row, filtered, static_cast<size_t>(width));
      return true;
    case kSub:
      for (int x = 0; x < width; ++x) row[x] = left = static_cast<uint8_t>(filtered[x] + left);
      return true;
    case kUp:
      for (int x = 0; x < width; ++x) row[x] = static_cast<uint8_t>(filtered[x] + above[x]);
      return true;
    case kAverage:
      for (int x = 0; x < width; ++x) {
        row[x] = left = static_cast<uint8_t>(filtered[x] + (left + above[x]) / 2);
      }
      return true;
    case kPaeth:
      unfilterPaeth(filtered, above, width, row);
      return true;
    default:
      return false;
  }
}

}  // namespace

bool unfilter(const uint8_t* filtered, int width, int height, uint8_t* pixels) {
  const std::vector<uint8_t> black(static_cast<size_t>(width), 0);
  const uint8_t* above = black.data();
  const ptrdiff_t stride = width + 1;
  for (int y = 0; y < height;) {
    if (y + 1 < height && filtered[0] == kPaeth && filtered[stride] == kPaeth) {
      unfilterPaethPair(filtered + 1, above, width, pixels);
      filtered += 2 * stride;
      pixels += 2 * width;
      y += 2;
    } else {
      if (!unfilterRow(filtered[0], filtered + 1, above, width, pixels)) return false;
      filtered += stride;
      pixels += width;
      ++y;
    }
    above = pixels - width;
  }
  return true;
}

}  // namespace lodeline::png

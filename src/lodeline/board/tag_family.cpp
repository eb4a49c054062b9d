#include "lodeline/board/tag_family.h"

extern "C" {
#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
}

namespace lodeline {

TagFamily::TagFamily(int border_cells)
    : border_cells_(border_cells), family_(tag36h11_create(), tag36h11_destroy) {
  // The bits count from the outer edge of the black border. The library's own border has one cell.
  const int more = border_cells - 1;
  family_->width_at_border += 2 * more;
  family_->total_width += 2 * more;
  for (uint32_t i = 0; i < family_->nbits; ++i) {
    family_->bit_x[i] += static_cast<uint32_t>(more);
    family_->bit_y[i] += static_cast<uint32_t>(more);
  }
}

bool TagFamily::isBlack(int tag, int column, int row) const {
  for (uint32_t i = 0; i < family_->nbits; ++i) {
    if (static_cast<int>(family_->bit_x[i]) == column && static_cast<int>(family_->bit_y[i]) == row)
      return (family_->codes[tag] >> (family_->nbits - 1 - i) & 1) == 0;
  }
  return true;
}

}  // namespace lodeline

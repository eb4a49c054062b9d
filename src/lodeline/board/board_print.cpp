#include "lodeline/board/board_print.h"

#include <algorithm>
#include <cmath>

#include "lodeline/board/tag_family.h"

namespace lodeline {

BoardPrint::BoardPrint(const CalibrationBoard& board) : board_(board) {
  const TagFamily family(2);
  width_cells_ = family.width();
  for (int tag = 0; tag < board.tagCount(); ++tag) {
    for (int row = 0; row < width_cells_; ++row) {
      for (int column = 0; column < width_cells_; ++column)
        black_.push_back(family.isBlack(tag, column, row) ? 1 : 0);
    }
  }
}

bool BoardPrint::isBlack(double x_m, double y_m) const {
  const double pitch_m = board_.pitch_m();
  const int column = static_cast<int>(std::floor(x_m / pitch_m)),
            row = static_cast<int>(std::floor(y_m / pitch_m));
  if (column < -1 || row < -1 || column >= board_.columns || row >= board_.rows) return false;
  const double x = (x_m - column * pitch_m) / board_.tag_size_m,
               y = (y_m - row * pitch_m) / board_.tag_size_m;
  const bool in_gap_x = x >= 1.0, in_gap_y = y >= 1.0;
  if (in_gap_x && in_gap_y) return true;
  if (in_gap_x || in_gap_y || column < 0 || row < 0) return false;
  const int cell_x = std::min(static_cast<int>(x * width_cells_), width_cells_ - 1);
  const int cell_y = std::min(static_cast<int>((1.0 - y) * width_cells_), width_cells_ - 1);
  const int tag = row * board_.columns + column;
  return black_[static_cast<size_t>((tag * width_cells_ + cell_y) * width_cells_ + cell_x)] != 0;
}

}  // namespace lodeline

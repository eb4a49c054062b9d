#pragma once

#include <vector>

#include "lodeline/board/calibration_board.h"

namespace lodeline {

/// The print of a board as a function of the place: tags with two cells of border, and the squares at the
/// crossings of the gaps.
class BoardPrint {
 public:
  explicit BoardPrint(const CalibrationBoard& board);

  const CalibrationBoard& board() const { return board_; }
  /// Whether the print is black at a place of T (m).
  bool isBlack(double x_m, double y_m) const;

 private:
  CalibrationBoard board_;
  int width_cells_;
  std::vector<char> black_;  ///< by tag, row from above, column
};

}  // namespace lodeline

#pragma once

#include <memory>

struct apriltag_family;

namespace lodeline {

/// The family 36h11 of AprilTags with a black border of one or two cells around the 6 x 6 bits. AprilTag
/// prints one cell, Kalibr two. The codes are those of libapriltag.
class TagFamily {
 public:
  explicit TagFamily(int border_cells);

  /// Number of cells along an edge, with the black border.
  int width() const { return 6 + 2 * border_cells_; }
  /// Whether a cell is black; columns from the left, rows from above.
  bool isBlack(int tag, int column, int row) const;

  apriltag_family* get() const { return family_.get(); }

 private:
  int border_cells_;
  std::unique_ptr<apriltag_family, void (*)(apriltag_family*)> family_;
};

}  // namespace lodeline

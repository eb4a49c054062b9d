#pragma once

#include <vector>

#include "simulation/rendering/board/printed_panel.h"
#include "simulation/rendering/cave/cave_layout.h"

namespace lodeline {

/// An AprilTag of the family 36h11 on a plate that hangs on the line of a cave.
struct LineTag {
  int id = 0;
  double size_m = 0.15;  ///< edge of the black square
  /// From the frame of the tag to the frame C of the cave. The origin of the tag is its middle; x points
  /// right, y up, z out of the print.
  Rigid3 cave_from_tag;

  /// Corners of the black square: lower left, lower right, upper right, upper left, as libapriltag counts.
  Vec3 corner_C(int k) const;
};

/// A part of a passage along which the line runs.
struct LinedStretch {
  int passage = 0;
  double from_m = 0.0, to_m = 0.0;  ///< arc lengths
};

/// Places tags 0 to count - 1 evenly along the line, in turns of random sides. They hang just outside the
/// diver's corridor and face divers who come from the start. They are askew by about 8 degrees about each
/// axis.
std::vector<LineTag> placeTags(const CaveLayout& cave, const std::vector<LinedStretch>& line, int count,
                               uint64_t seed);

/// Grey plates in the frame C: the front sides first, one after another, then grey back sides.
TriangleMesh makeTagMesh(const std::vector<LineTag>& tags);

/// The print of a tag in a world in which the frame C has its origin at `cave_origin_W`.
PrintedPanel tagPanel(const LineTag& tag, const Vec3& cave_origin_W);

}  // namespace lodeline

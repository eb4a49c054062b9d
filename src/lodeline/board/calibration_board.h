#pragma once

#include <filesystem>
#include <string>

#include "lodeline/diagnostics.h"
#include "lodeline/types.h"

namespace lodeline {

/// A grid of AprilTags of the family 36h11, as Kalibr's `aprilgrid`. The board frame T has its origin at the
/// lower left corner of tag 0. x is to the right, y up and z out of the print. The numbers of the tags grow
/// along x, then along y. Black squares fill the crossings of the gaps, so that every corner of a tag is a
/// saddle point of the image.
struct CalibrationBoard {
  static constexpr int kFamilySize = 587;  ///< number of tags in the family

  int columns = 6;           ///< of tags
  int rows = 6;              ///< of tags
  double tag_size_m = 0.08;  ///< edge of the black square of a tag
  double spacing = 0.3;      ///< gap between tags over tag_size_m

  int tagCount() const { return columns * rows; }
  /// A tag has the corners 0 to 3: lower left, lower right, upper right, upper left.
  int cornerCount() const { return 4 * tagCount(); }
  double pitch_m() const { return tag_size_m * (1.0 + spacing); }
  double gap_m() const { return tag_size_m * spacing; }
  double width_m() const { return columns * pitch_m() - gap_m(); }
  double height_m() const { return rows * pitch_m() - gap_m(); }

  /// Position of corner 4 * tag + k in T, m.
  Vec3 corner_T(int index) const;
};

/// Reads Kalibr's description of a board: `target_type: aprilgrid`, `tagCols`, `tagRows`, `tagSize` (m),
/// `tagSpacing`. Throws InputError naming file and key for other boards and for impossible values.
CalibrationBoard readBoard(const std::filesystem::path& file);

/// The board in the format of readBoard().
std::string boardText(const CalibrationBoard& board);

/// "6 x 6 tags of the family 36h11, 80 mm wide", for messages.
std::string boardWords(const CalibrationBoard& board);

}  // namespace lodeline

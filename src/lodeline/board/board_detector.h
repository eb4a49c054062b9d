#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "lodeline/board/calibration_board.h"

namespace lodeline {

class TagDetector;

/// A corner of the board in an image.
struct BoardCorner {
  int index = 0;  ///< see CalibrationBoard::corner_T
  Vec2 pixel = Vec2::Zero();
};

/// Finds a board in images: tags by libapriltag (J. Wang, E. Olson, "AprilTag 2: efficient and robust
/// fiducial detection", IROS 2016), then every corner as the saddle point nearby. Accepts tags with one and
/// with two cells of border. One detector serves one thread.
class BoardDetector {
 public:
  explicit BoardDetector(const CalibrationBoard& board);
  ~BoardDetector();

  /// Least number of tags in a view. With fewer, a wrong number of a tag would not show.
  static constexpr size_t kLeastTags = 4;

  /// The corners in an 8-bit grey image, by index; empty where fewer than kLeastTags tags fit the board.
  std::vector<BoardCorner> detect(const cv::Mat& image) const;

 private:
  CalibrationBoard board_;
  std::unique_ptr<TagDetector> tags_;
};

}  // namespace lodeline

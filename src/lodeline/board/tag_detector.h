#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// A tag in an image.
struct FoundTag {
  int id = 0;
  double border_share = 0.2;  ///< width of the black border over the edge
  int wrong_bits = 0;         ///< that the code corrects
  double margin = 0.0;        ///< contrast of the bits, grey values
  /// Of the black square, px: lower left, lower right, upper right, upper left of the print. The family's
  /// codes tell which corner is which.
  Vec2 corners[4];

  double edge_px() const;  ///< the shortest
};

/// Finds AprilTags of the family 36h11 in images, with one and with two cells of border (J. Wang, E. Olson,
/// "AprilTag 2: efficient and robust fiducial detection", IROS 2016). One detector serves one thread.
class TagDetector {
 public:
  TagDetector();
  ~TagDetector();
  TagDetector(const TagDetector&) = delete;
  TagDetector& operator=(const TagDetector&) = delete;

  /// Tags with ids below `tag_count` in an 8-bit grey image.
  std::vector<FoundTag> find(const cv::Mat& image, int tag_count) const;

 private:
  struct Library;

  std::unique_ptr<Library> library_;
};

}  // namespace lodeline

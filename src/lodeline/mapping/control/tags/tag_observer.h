#pragma once

#include <array>
#include <map>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "lodeline/board/tag_detector.h"
#include "lodeline/cameras/camera.h"
#include "lodeline/mapping/keyframe/map_keyframe.h"
#include "lodeline/mapping/store/map_records.h"

namespace lodeline {

struct TagOptions {
  double size_m = 0.0;             ///< edge of the black square; 0: unknown, tags then give rays alone
  std::map<int, double> sizes_m;   ///< of tags with another size
  double size_sigma_share = 0.01;  ///< one sigma of the size over the size: the scale of a print
  double corner_sigma_px = 0.3;    ///< of a corner along each axis
  /// The code corrects wrong bits. A tag is an identity, so none is accepted: of 10^6 random squares without
  /// wrong bits, less than one is a tag.
  int most_wrong_bits = 0;
  double least_edge_px = 12.0;   ///< ten cells across need at least that many pixels
  double most_rms_sigmas = 4.0;  ///< of a square of the stated size

  /// Throws UsageError for impossible values.
  void check() const;
};

/// A tag seen at one keyframe.
struct TagObservation {
  int tag = 0;
  std::array<BodyRay, 4> corners;         ///< lower left, lower right, upper right, upper left of the print
  std::optional<PositionPrior> centre_B;  ///< where the size is known
};

/// Finds AprilTags (36h11) on the line in images of one camera.
class TagObserver {
 public:
  /// `camera_index`: of the camera in its rig.
  TagObserver(std::shared_ptr<const Camera> camera, const Rigid3& body_from_camera, int camera_index,
              const TagOptions& options);

  /// Tags in an 8-bit grey image, each once, by number. Tags that appear twice in one image are left out.
  std::vector<TagObservation> observe(const cv::Mat& image) const;

 private:
  std::optional<TagObservation> observation(const FoundTag& tag) const;
  std::optional<BodyRay> rayOf(const Vec2& pixel) const;

  std::shared_ptr<const Camera> camera_;
  Rigid3 body_from_camera_;
  int camera_index_;
  TagOptions options_;
  TagDetector detector_;
};

}  // namespace lodeline

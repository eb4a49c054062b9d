#include "lodeline/board/tag_detector.h"

#include <algorithm>
#include <limits>

#include "lodeline/board/tag_family.h"

extern "C" {
#include <apriltag/apriltag.h>
}

namespace lodeline {
namespace {

constexpr double kPixelsOfFullDetection = 1.0e6;  ///< larger images are searched at half the resolution
constexpr float kLeastMargin = 20.0f;             ///< contrast of the bits, grey values

}  // namespace

struct TagDetector::Library {
  TagFamily narrow{1}, wide{2};
  std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)> detector{apriltag_detector_create(),
                                                                                apriltag_detector_destroy};
  Library() {
    detector->nthreads = 1;
    apriltag_detector_add_family(detector.get(), narrow.get());
    apriltag_detector_add_family(detector.get(), wide.get());
  }
};

double FoundTag::edge_px() const {
  double shortest = std::numeric_limits<double>::max();
  for (int k = 0; k < 4; ++k) shortest = std::min(shortest, (corners[k] - corners[(k + 1) % 4]).norm());
  return shortest;
}

TagDetector::TagDetector() : library_(std::make_unique<Library>()) {}
TagDetector::~TagDetector() = default;

std::vector<FoundTag> TagDetector::find(const cv::Mat& image, int tag_count) const {
  apriltag_detector_t* detector = library_->detector.get();
  detector->quad_decimate = static_cast<double>(image.total()) > kPixelsOfFullDetection ? 2.0f : 1.0f;
  image_u8_t view = {image.cols, image.rows, static_cast<int>(image.step), image.data};
  zarray_t* detections = apriltag_detector_detect(detector, &view);
  std::vector<FoundTag> tags;
  for (int i = 0; i < zarray_size(detections); ++i) {
    apriltag_detection_t* detection = nullptr;
    zarray_get(detections, i, &detection);
    if (detection->id >= tag_count || detection->decision_margin < kLeastMargin) continue;
    FoundTag tag;
    tag.id = detection->id;
    tag.border_share = detection->family == library_->narrow.get() ? 1.0 / library_->narrow.width()
                                                                   : 2.0 / library_->wide.width();
    tag.wrong_bits = detection->hamming;
    tag.margin = detection->decision_margin;
    // The library puts the centre of the first pixel at (0.5, 0.5).
    for (int k = 0; k < 4; ++k) tag.corners[k] = Vec2(detection->p[k][0] - 0.5, detection->p[k][1] - 0.5);
    tags.push_back(tag);
  }
  apriltag_detections_destroy(detections);
  return tags;
}

}  // namespace lodeline

#pragma once

#include <cstdint>
#include <deque>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "lodeline/frontend/detection/image_pyramid.h"
#include "lodeline/types.h"

namespace lodeline {

struct StaticImageMaskOptions {
  bool enabled = true;
  double interval_s = 0.25;         ///< minimum interval between samples
  double settled_interval_s = 1.0;  ///< the interval once `max_looks` samples were taken
  /// In two samples that show the same scene, more than this share of the strong texture agrees. A sample in
  /// which this holds for more than half of the image contains no new information: the camera is at rest or
  /// has returned.
  double max_agreement = 0.6;
  int min_looks = 10;
  int max_looks = 32;  ///< maximum number of stored samples
  /// Norm of the mean gradient direction at a position (mean of unit vectors). It counts as static from
  /// `min_persistence` on (with fewer than 16 samples: from the limit that chance does not exceed), and no
  /// longer below `end_persistence`.
  double min_persistence = 0.75;
  double end_persistence = 0.5;
  double margin_px = 12.0;  ///< around the mask, because patches extend that far
  double max_share = 0.7;   ///< of the image; a larger mask is not plausible and not used
};

/// Detects structures that are fixed in a camera's images while everything else moves: parts of the rig in
/// the view, a hood's edge, dirt and bubbles on the port, characters written on the image. Points tracked
/// there do not belong to the world. At such positions the gradient direction is the same in all samples,
/// elsewhere it is random. A sample counts only if it differs from all stored ones, so that a camera at rest
/// creates no static structure.
class StaticImageMask {
 public:
  explicit StaticImageMask(const StaticImageMaskOptions& options) : options_(options) {}

  /// Adds an image; cheap if no sample is due.
  void add(Time time, const ImagePyramid& image);

  /// 8-bit mask of the size of `image`'s first level, zero where a structure is static; empty while there is
  /// none.
  const cv::Mat& mask() const { return mask_; }
  double share() const { return share_; }  ///< of the image that is masked
  int looks() const { return static_cast<int>(looks_.size()); }

 private:
  /// Gradient directions as unit vectors times 100; zero where texture is weak.
  struct Look {
    cv::Size size;
    std::vector<int8_t> x, y;
    std::vector<std::vector<int>>
        strong;  ///< indices of the strongest texture in each tile that has enough of it
  };

  static Look look(const ImagePyramid& image);
  bool isKnown(const Look& look) const;
  bool agree(const Look& look, const Look& other) const;
  void count(const Look& look, int sign);
  void update(cv::Size size, cv::Size image_size);

  StaticImageMaskOptions options_;
  Time last_;
  bool first_ = true;
  std::deque<Look> looks_;
  std::vector<int> sum_x_, sum_y_;  ///< over all samples
  cv::Mat fixed_;                   ///< at the samples' size, 255 where a structure is static
  cv::Mat mask_;
  double share_ = 0.0;
};

}  // namespace lodeline

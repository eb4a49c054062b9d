#pragma once

#include <cstdint>
#include <deque>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "lodeline/frontend/detection/image_pyramid.h"
#include "lodeline/util/time/time.h"

namespace lodeline {

struct StaticImageMaskOptions {
  bool enabled = true;
  double interval_s = 0.25;         ///< between looks, at least
  double settled_interval_s = 1.0;  ///< once as many as are remembered were taken
  /// Where two looks show the same place of the world, more than this share of their strong texture agrees. A
  /// look in which that is so of more than half of the image says nothing new: the camera stands still, or
  /// has swayed back.
  double max_agreement = 0.6;
  int min_looks = 10;
  int max_looks = 32;  ///< that are remembered
  /// Length of the mean of the unit directions in which grey values rise at a place, from which on it is
  /// fixed (with fewer than 16 looks: that which chance does not make), and below which it no longer is.
  double min_persistence = 0.75;
  double end_persistence = 0.5;
  double margin_px = 12.0;  ///< around it: patches reach that far
  double max_share = 0.7;   ///< of the image; more of it is not believed
};

/// Finds what stays at its place in a camera's images while all else moves: parts of the rig in the view, a
/// hood's edge, dirt and bubbles on the port, characters written over the picture. Points followed there do
/// not belong to the world. Grey values rise in the same direction wherever it is, look after look, and in
/// any direction elsewhere. Looks only count where they differ from all others remembered, so standing still
/// makes nothing fixed.
class StaticImageMask {
 public:
  explicit StaticImageMask(const StaticImageMaskOptions& options) : options_(options) {}

  /// Takes an image into account; cheap where nothing is due.
  void add(Time time, const ImagePyramid& image);

  /// 8-bit of the size of `image`'s first level, zero where something is fixed; empty while nothing is.
  const cv::Mat& mask() const { return mask_; }
  double share() const { return share_; }  ///< of the image that is masked
  int looks() const { return static_cast<int>(looks_.size()); }

 private:
  /// Directions in which grey values rise, times 100; zero where texture is weak.
  struct Look {
    cv::Size size;
    std::vector<int8_t> x, y;
    std::vector<std::vector<int>>
        strong;  ///< indices of the strongest texture, of each tile that has enough of it
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
  std::vector<int> sum_x_, sum_y_;  ///< over all looks
  cv::Mat fixed_;                   ///< at the looks' size, 255 where something is fixed
  cv::Mat mask_;
  double share_ = 0.0;
};

}  // namespace lodeline

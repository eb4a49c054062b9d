#pragma once

#include <opencv2/core.hpp>

#include "lodeline/types.h"

namespace lodeline {

/// A layer in which fresh water lies on salt water. Index and density rise over its thickness. Within it the
/// waters mix in streaks of different index, which blurs the view.
struct Halocline {
  double height_W = 0.0;  ///< of its middle, m
  double thickness_m = 0.2;
  double index_step = 0.0064;  ///< of the salt water over the fresh
  double blur_px_per_m = 4.0;  ///< blur of a path of one metre within the layer, for an image 640 px wide

  /// Share of salt at a height: 0 above, 1 below, linear between.
  double saltShare(double height_W_m) const;

  /// Length of a path within the layer between two heights, m.
  double pathWithin(double from_height_m, double to_height_m, double length_m) const;
};

/// Blurs a radiance image (CV_32F) by the path of each ray within the layer. `heights_m` (CV_32F) are those
/// of the points in view.
void blurByHalocline(cv::Mat& radiance, const cv::Mat& range_m, const cv::Mat& heights_m, double eye_height_m,
                     const Halocline& halocline);

}  // namespace lodeline

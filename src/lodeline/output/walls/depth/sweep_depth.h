#pragma once

#include <vector>

#include "lodeline/output/walls/depth/depth_image.h"

namespace lodeline {

/// A rectified 8-bit grey image with its pose.
struct SweepFrame {
  Rigid3 map_from_view;
  cv::Mat grey;
};

/// Depths of one camera from its neighbouring keyframes, whose poses are known: a plane sweep (R. Collins, "A
/// space-sweep approach to true multi-image matching", CVPR 1996).
///
/// For planes z = const at even steps of 1/z, each neighbour is warped into the keyframe by the homography
/// K (R + t n^T / z) K^-1. The cost is the Hamming distance of census transforms (R. Zabih, J. Woodfill,
/// ECCV 1994) in a window. Neighbours before and after count apart and the better side is taken, since a
/// surface may be hidden from the other. A depth is kept where the best cost is distinct, the surface has
/// texture, and the expected error is small enough; it is large where the camera moves along the ray.
class SweepDepth {
 public:
  /// Keeps a reference to `view`.
  SweepDepth(const RectifiedView& view, const DepthImageOptions& options);

  /// The result has no colour; it is empty of depths without neighbours.
  DepthImage compute(const SweepFrame& keyframe, const std::vector<SweepFrame>& before,
                     const std::vector<SweepFrame>& after) const;

 private:
  struct Neighbour {
    Mat3 rotation;  ///< neighbour from keyframe
    Vec3 translation;
    cv::Mat grey;
  };
  std::vector<Neighbour> placed(const SweepFrame& keyframe, const std::vector<SweepFrame>& frames) const;
  cv::Mat warped(const Neighbour& neighbour, double inverse_depth) const;
  /// Mean cost of the neighbours at one plane, CV_32F.
  cv::Mat cost(const cv::Mat& census, const std::vector<Neighbour>& neighbours, double inverse_depth) const;
  double inverseDepth(double plane) const { return far_ + plane * step_; }
  /// Largest movement of a pixel by inverse depth among the neighbours, px m.
  double parallax(const std::vector<Neighbour>& neighbours, int u, int v, double inverse_depth) const;

  const RectifiedView& view_;
  DepthImageOptions options_;
  double far_, step_;  ///< 1/m
};

}  // namespace lodeline

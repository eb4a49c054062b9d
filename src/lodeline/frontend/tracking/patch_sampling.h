#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>

#include "lodeline/frontend/tracking/patch_pattern.h"

namespace lodeline {

/// Position of a patch in an image: pattern offset u maps to `position + linear * u` (px of level 0).
struct PatchWarp {
  Eigen::Vector2f position = Eigen::Vector2f::Zero();
  Eigen::Matrix2f linear = Eigen::Matrix2f::Identity();
};

/// Whether all samples of a warped patch, with a margin of `margin` pixels, are inside the image.
bool staysInside(const cv::Mat& image, const PatchWarp& warp, float margin);

/// Bilinear values of a CV_32FC1 image at the warped pattern, which must stay inside.
void sample(const cv::Mat& image, const PatchWarp& warp, PatchValues& values);

float dot(const PatchValues& a, const PatchValues& b);

/// Subtracts constant and linear trend.
void detrend(PatchValues& values);

/// Detrends and scales to unit norm; returns the norm before.
float normalize(PatchValues& values);

/// Scalar products of the normalized values with rows that are free of trend, computed without normalization,
/// because the trend drops out of every such product. All zero where the values have no contrast.
template <size_t kRows>
std::array<float, kRows> normalizedAlong(const PatchValues& values,
                                         const std::array<const PatchValues*, kRows>& rows);

/// Derivative of `normalize`, except for the scale, applied to a column of a Jacobian: it projects out the
/// trend and the normalized values themselves.
void projectOutNormalization(const PatchValues& normalized, PatchValues& column);

/// Neighbourhood of a point without rotation, resampled so that every sample of the pattern and its four
/// neighbours are on its grid. This is cheaper than a separate interpolation of each sample.
class PatchBlock {
 public:
  static constexpr float kReach = PatchPattern::kReach + 1.0F;

  /// `centre` must lie at least `kReach` pixels inside the CV_32FC1 image.
  PatchBlock(const cv::Mat& image, const Eigen::Vector2f& centre);

  void values(PatchValues& values) const;
  /// Gradients by central differences, per px times `scale`.
  void gradients(float scale, PatchValues& by_u, PatchValues& by_v) const;

 private:
  static constexpr int kSide = static_cast<int>(2.0F * kReach) + 1;

  const float* at(size_t i) const {
    return values_.data() + static_cast<int>(kPatchV[i] + kReach) * kSide +
           static_cast<int>(kPatchU[i] + kReach);
  }

  std::array<float, static_cast<size_t>(kSide) * static_cast<size_t>(kSide)> values_;
};

}  // namespace lodeline

#pragma once

#include <array>
#include <optional>
#include <vector>

#include "lodeline/frontend/detection/image_pyramid.h"
#include "lodeline/frontend/tracking/patch_sampling.h"

namespace lodeline {

/// Parameters of a warp that an alignment estimates: its position, or its linear part as well.
enum class PatchMotion { Shift, Deformation };

/// Quality of an alignment.
struct PatchMatch {
  float correlation = 0.0F;    ///< of the normalized patches at the finest level, 1 = equal
  float residual_grey = 0.0F;  ///< RMS difference after normalization, grey levels of the template
};

/// Template of a small image patch on several pyramid levels, with all quantities that can be precomputed for
/// its alignment in other images.
///
/// Alignment is inverse compositional Gauss-Newton (S. Baker, I. Matthews, "Lucas-Kanade 20 years on", IJCV
/// 2004) on normalized values. Constant, linear trend and gain are removed from template and image. A lamp
/// that moves with the camera projects a bright area with steep gradients on the rock, which is fixed in the
/// image. Any rest of it in the residual would hold the patch in place.
class PatchTemplate {
 public:
  PatchTemplate() = default;

  /// `motion`: the most general motion that align() will ever estimate. Empty where the finest level is not
  /// inside the image or has no texture. Coarser levels that are not inside the image are skipped.
  static std::optional<PatchTemplate> extract(const ImagePyramid& image, const Eigen::Vector2f& centre,
                                              int levels, PatchMotion motion = PatchMotion::Deformation);

  /// Aligns the template in another image, from level `coarsest` down to the image itself. Deformation also
  /// estimates the linear part of the warp, on the finest level. Empty where it leaves the image or does not
  /// converge; `warp` is then unspecified.
  std::optional<PatchMatch> align(const ImagePyramid& image, int coarsest, PatchMotion motion,
                                  PatchWarp& warp) const;

  /// Correlation of the image at `warp` with the template on one level, without alignment; empty outside the
  /// image.
  std::optional<float> correlate(const ImagePyramid& image, int level, const PatchWarp& warp) const;

  int levels() const { return static_cast<int>(levels_.size()); }
  /// Root of the sum of squares of the detrended template on the finest level, grey levels.
  float contrastGrey() const { return contrast_grey_; }

 private:
  static constexpr int kParameters = 6;
  using Jacobian = std::array<PatchValues, kParameters>;
  struct Level {
    bool valid = false;
    PatchValues values{};  ///< normalized
    /// Pseudo-inverse of the Jacobian of the normalized values by the shift, row by row.
    std::array<PatchValues, 2> shift_gain{};
  };

  /// Computes the Jacobian of the normalized values by the shift, or by (shift, linear part).
  static bool fillLevel(const cv::Mat& image, const Eigen::Vector2f& centre, PatchMotion motion, Level& level,
                        Jacobian& jacobian, float& norm);
  void invertInformation();
  bool shiftOnLevel(const Level& level, const cv::Mat& image, float converged_px, PatchWarp& warp,
                    float& correlation) const;
  bool deform(const cv::Mat& image, PatchWarp& warp, float& correlation) const;

  std::vector<Level> levels_;
  PatchMotion most_ = PatchMotion::Shift;
  /// Jacobian on the finest level, by (shift, linear part), and the inverse of its damped square; not
  /// computed in a template that is only shifted.
  Jacobian jacobian_{};
  Eigen::Matrix<float, kParameters, kParameters> inverse_information_;
  float contrast_grey_ = 0.0F;
};

}  // namespace lodeline

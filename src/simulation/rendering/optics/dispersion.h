#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "simulation/rendering/optics/camera_optics.h"

namespace lodeline {

/// A part of the band of a grey camera. The response combines the lamp (white LED), the wall (warm limestone)
/// and the sensor (silicon). The absorption is that of pure water (R. Pope and E. Fry, Applied Optics 36,
/// 1997).
struct SpectralBand {
  double wavelength_nm;
  float response;
  float absorption_per_m;
};
inline constexpr std::array<SpectralBand, 5> kSpectralBands = {{{450.0, 0.48f, 0.0092f},
                                                                {500.0, 0.43f, 0.0204f},
                                                                {550.0, 1.00f, 0.0565f},
                                                                {600.0, 0.85f, 0.2224f},
                                                                {650.0, 0.41f, 0.3400f}}};

/// Dispersion of a camera behind a port: the indices of water and glass depend on the wavelength, so a grey
/// camera smears a point radially. The water absorbs red first, so the centroid of a point depends on its
/// distance.
class Dispersion {
 public:
  /// `optics` are those of a camera with a port, at kMiddleWavelength_nm.
  explicit Dispersion(const CameraOptics& optics);

  /// Offset (px) from a pixel in light of the band to the pixel that sees its ray in light of the middle
  /// wavelength.
  Vec2 shift(int band, double x_px, double y_px) const;

  /// Mean offset for light from a wall at `range_m`, px.
  Vec2 meanShift(double x_px, double y_px, float range_m) const;

  /// Replaces an image of light of the middle wavelength (CV_32F) by one of the whole band.
  void smear(cv::Mat& radiance, const cv::Mat& range_m) const;

 private:
  using Weights = std::array<float, kSpectralBands.size()>;
  static Weights weightsAt(float range_m);

  int columns_, rows_;
  std::vector<std::array<Eigen::Vector2f, kSpectralBands.size()>> nodes_;
};

}  // namespace lodeline

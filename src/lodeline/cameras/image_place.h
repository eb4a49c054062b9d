#pragma once

#include <numbers>

#include "lodeline/cameras/camera.h"

namespace lodeline {

/// Angle to the axis of the widest lenses made. No fisheye model is valid beyond it.
constexpr double kWidestLens_rad = 115.0 * std::numbers::pi / 180.0;
/// Distance from an angle at which a model ends: where the pixel stops to move with the angle, or becomes
/// infinite. At this distance rounding costs less than 1e-12 rad.
constexpr double kMarginToTheEnd_rad = 1e-3;

/// Image scale of a lens with rotational symmetry. A point (x, y, z) has the position scale * (x, y) in the
/// image, in units of the focal lengths. The models have at most two parameters.
struct ImageScale {
  double scale = 0.0;
  Vec3 by_point = Vec3::Zero();
  Vec2 by_parameters = Vec2::Zero();

  /// Scale 1 / divisor with the divisor's derivatives.
  static ImageScale inverseOf(double divisor, const Vec3& by_point, const Vec2& by_parameters) {
    const double scale = 1.0 / divisor;
    return {scale, -scale * scale * by_point, -scale * scale * by_parameters};
  }
};

/// Position of a pixel in units of the focal lengths.
inline Vec2 placeOf(const CameraCalibration& c, const Vec2& pixel) {
  return Vec2((pixel.x() - c.cx_px) / c.fx_px, (pixel.y() - c.cy_px) / c.fy_px);
}

/// Sets the columns of fx, fy, cx and cy for a position in units of the focal lengths, and sizes the others.
inline void setPinholeColumns(const CameraCalibration& c, const Vec2& place, PixelByParameters* columns) {
  columns->setZero(2, 4 + static_cast<Eigen::Index>(c.distortion.size()));
  columns->leftCols<2>() = place.asDiagonal();
  columns->middleCols<2>(2).setIdentity();
}

/// Pixel of a point by its image scale, with the derivatives of Camera::project.
inline Vec2 pixelByScale(const CameraCalibration& c, const Vec3& point_C, const ImageScale& image,
                         Mat23* pixel_by_point, PixelByParameters* pixel_by_parameters) {
  const Vec2 focal_lengths_px(c.fx_px, c.fy_px);
  const Vec2 lateral = point_C.head<2>();
  const Vec2 place = image.scale * lateral;
  if (pixel_by_point) {
    Mat23 place_by_point = lateral * image.by_point.transpose();
    place_by_point.leftCols<2>().diagonal().array() += image.scale;
    *pixel_by_point = focal_lengths_px.asDiagonal() * place_by_point;
  }
  if (pixel_by_parameters) {
    setPinholeColumns(c, place, pixel_by_parameters);
    const Vec2 by_scale = focal_lengths_px.cwiseProduct(lateral);
    for (Eigen::Index k = 4; k < pixel_by_parameters->cols(); ++k)
      pixel_by_parameters->col(k) = by_scale * image.by_parameters[k - 4];
  }
  return focal_lengths_px.cwiseProduct(place) + Vec2(c.cx_px, c.cy_px);
}

}  // namespace lodeline

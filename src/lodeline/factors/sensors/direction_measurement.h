#pragma once

#include "lodeline/cameras/camera.h"

namespace lodeline {

/// What one image says about the direction of a point: the unit ray z of the pixel, a basis B (3x2) of the
/// plane normal to it, and the weight that turns an offset in that plane into pixels over their standard
/// deviation,
///   sqrt_information = d(pixel) / d(tangent offset) / sigma_px      (2x2).
/// With the curvature of the image about the pixel, a residual is the pixel error over sigma to second order,
/// for every camera model and without evaluating the distortion again. To first order alone it is not enough:
/// of noise that has no mean in pixels the square would be left, outwards, and calibrations take it for a
/// shorter lens.
struct DirectionMeasurement {
  Vec3 bearing_C = Vec3::UnitZ();
  Mat32 tangent_C = Mat32::Identity();
  Mat2 sqrt_information = Mat2::Identity();
  /// d^2(pixel) / d(offset a, b)^2 / sigma_px; columns aa, ab, bb.
  Mat23 curvature = Mat23::Zero();
  Vec2 from_centre_sigmas = Vec2::Zero();    ///< pixel minus principal point, over sigma_px
  double sigmas_per_px = 1.0;                ///< 1 / sigma_px
  Vec2 focal_lengths_sigmas = Vec2::Ones();  ///< over sigma_px
  /// Where the ray lies in the plane in which the lens' model counts its radius: as far from the centre as
  /// the tangent of the angle off the axis, of an equidistant lens the angle.
  Vec2 in_plane = Vec2::Zero();
  Mat2 in_plane_by_sigmas = Mat2::Zero();  ///< d(in_plane) / d(pixel over sigma_px)

  /// From a pixel's ray. The camera must be able to project that ray.
  static DirectionMeasurement fromBearing(const Camera& camera, const Vec3& bearing_C, double sigma_px);
};

/// Residual of a DirectionMeasurement for the homogeneous point q (target camera frame, any positive scale),
/// with the derivative d(residual)/dq where asked for. With the offset o = B^T q / (z^T q) in the tangent
/// plane,
///   residual = sqrt_information * o + (curvature * (o_a^2, 2 o_a o_b, o_b^2)) / 2,
/// where the second term goes on linearly, in place of by the square, beyond a tenth of a radian.
Vec2 directionResidual(const DirectionMeasurement& measurement, const Vec3& point_C, Mat23* by_point);

}  // namespace lodeline

#pragma once

#include "lodeline/cameras/camera_model.h"

namespace lodeline {

/// Measured direction of a point in one image. z is the unit ray of the pixel and B (3x2) a basis of the
/// plane normal to it. The weight converts an offset in that plane into pixels over their standard deviation,
///   sqrt_information = d(pixel) / d(tangent offset) / sigma_px      (2x2).
/// With the curvature of the image at the pixel, a residual equals the pixel error over sigma to second
/// order. This holds for every camera model without a further evaluation of the distortion. The first order
/// alone is not sufficient: zero-mean pixel noise would leave its square as an outward bias, and a
/// calibration would absorb that bias as a shorter focal length.
struct DirectionMeasurement {
  Vec3 bearing_C = Vec3::UnitZ();
  /// Point from which the ray comes, m. Behind a port, it differs from pixel to pixel.
  Vec3 origin_C = Vec3::Zero();
  Mat32 tangent_C = Mat32::Identity();
  Mat2 sqrt_information = Mat2::Identity();
  /// d^2(pixel) / d(offset a, b)^2 / sigma_px; columns aa, ab, bb.
  Mat23 curvature = Mat23::Zero();
  Vec2 from_centre_sigmas = Vec2::Zero();    ///< pixel minus principal point, over sigma_px
  double sigmas_per_px = 1.0;                ///< 1 / sigma_px
  Vec2 focal_lengths_sigmas = Vec2::Ones();  ///< on the axis, over sigma_px
  /// Position of the ray in the RadialPlane of the camera model. Its distance from the centre is the tangent
  /// of the angle to the optical axis, or the angle.
  Vec2 in_plane = Vec2::Zero();
  Mat2 in_plane_by_sigmas = Mat2::Zero();  ///< d(in_plane) / d(pixel over sigma_px)

  /// Measurement of a pixel whose ray is `bearing_C`. The camera must be able to project that ray.
  static DirectionMeasurement fromBearing(const Camera& camera, const Vec3& bearing_C, double sigma_px);

  /// Measurement of a pixel whose points are on the line `ray`, whatever their distance. The weight is that
  /// of a point at Camera::kNominalDistance_m.
  static DirectionMeasurement fromRay(const Camera& camera, const ViewRay& ray, double sigma_px);

  /// The point q of inverse scale rho as seen from the ray's origin, q - rho origin.
  Vec3 fromOrigin(const Vec3& point_C, double rho) const { return point_C - rho * origin_C; }
};

/// Position of a unit ray in a RadialPlane (DirectionMeasurement::in_plane) and its derivative by the ray.
Vec2 placeInPlane(RadialPlane plane, const Vec3& ray, Mat23* by_ray);

/// Residual of a DirectionMeasurement for the homogeneous point q (frame of the target camera, any positive
/// scale). `by_point` receives the derivative d(residual)/dq unless it is null. With the offset o = B^T q /
/// (z^T q) in the tangent plane,
///   residual = sqrt_information * o + (curvature * (o_a^2, 2 o_a o_b, o_b^2)) / 2.
/// Beyond a tenth of a radian the second term grows linearly instead of quadratically. A point more than
/// about 84 degrees from the measured ray has a large constant residual and a zero derivative.
Vec2 directionResidual(const DirectionMeasurement& measurement, const Vec3& point_C, Mat23* by_point);

}  // namespace lodeline

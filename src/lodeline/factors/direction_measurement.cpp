#include "lodeline/factors/direction_measurement.h"

#include <Eigen/LU>
#include <cmath>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

// Cosine of the angle to the measured ray below which a point is a gross outlier (about 84 degrees). Its
// residual, in sigmas.
constexpr double kMinCosine = 0.1;
constexpr double kOutlierResidual = 1e4;

/// Pixel of the nominal point of a ray whose direction is changed by `offset`, and its derivative by the
/// direction.
std::optional<Vec2> projectAlong(const Camera& camera, const ViewRay& ray, const Vec3& offset,
                                 Mat23* by_direction) {
  const auto pixel =
      camera.project(ray.origin_C + Camera::kNominalDistance_m * (ray.direction_C + offset), by_direction);
  *by_direction *= Camera::kNominalDistance_m;
  return pixel;
}

/// Second derivative d^2(pixel) / d(offset)^2, columns aa, ab, bb, by finite differences of the first
/// derivative. Zero where the camera cannot project the neighbouring ray.
Mat23 imageCurvature(const Camera& camera, const ViewRay& ray, const Mat32& tangent, const Mat2& by_offset) {
  constexpr double kStep = 1e-4;
  Mat23 curvature = Mat23::Zero();
  for (int axis = 0; axis < 2; ++axis) {
    Mat23 by_point;
    if (!projectAlong(camera, ray, kStep * tangent.col(axis), &by_point)) return Mat23::Zero();
    const Mat2 change = (by_point * tangent - by_offset) / kStep;
    curvature.col(2 * axis) = change.col(axis);
    curvature.col(1) += 0.5 * change.col(1 - axis);
  }
  return curvature;
}

/// The quadratic term of a residual. It is damped for large offsets, where the second order does not describe
/// the projection.
struct Quadratic {
  static constexpr double kFar_rad = 0.1;
  double damping;
  Vec2 value;

  Quadratic(const Mat23& curvature, const Vec2& offset)
      : damping(1.0 / std::sqrt(1.0 + offset.squaredNorm() / (kFar_rad * kFar_rad))) {
    const double a = offset.x(), b = offset.y();
    value = curvature * (damping * Vec3(0.5 * a * a, a * b, 0.5 * b * b));
  }
  Mat2 byOffset(const Mat23& curvature, const Vec2& offset) const {
    Mat2 by_offset;
    by_offset.col(0) = damping * (offset.x() * curvature.col(0) + offset.y() * curvature.col(1));
    by_offset.col(1) = damping * (offset.x() * curvature.col(1) + offset.y() * curvature.col(2));
    by_offset -= value * (damping * damping / (kFar_rad * kFar_rad) * offset).transpose();
    return by_offset;
  }
};

}  // namespace

Vec2 placeInPlane(RadialPlane plane, const Vec3& ray, Mat23* by_ray) {
  constexpr double kOnAxis = 1e-6;
  const double sine = ray.head<2>().norm();
  if (plane == RadialPlane::Tangent || sine < kOnAxis) {
    const Vec2 place = ray.head<2>() / ray.z();
    *by_ray << Mat2::Identity() / ray.z(), -place / ray.z();
    return place;
  }
  const Vec2 outwards = ray.head<2>() / sine;
  const double angle = std::atan2(sine, ray.z());
  by_ray->leftCols<2>() =
      angle / sine * Mat2::Identity() + (ray.z() - angle / sine) * outwards * outwards.transpose();
  by_ray->col(2) = -sine * outwards;
  return angle * outwards;
}

DirectionMeasurement DirectionMeasurement::fromBearing(const Camera& camera, const Vec3& bearing_C,
                                                       double sigma_px) {
  return fromRay(camera, {Vec3::Zero(), bearing_C}, sigma_px);
}

DirectionMeasurement DirectionMeasurement::fromRay(const Camera& camera, const ViewRay& ray,
                                                   double sigma_px) {
  const Vec3& bearing_C = ray.direction_C;
  DirectionMeasurement measurement;
  measurement.bearing_C = bearing_C;
  measurement.origin_C = ray.origin_C;
  measurement.tangent_C = tangentBasis(bearing_C);
  Mat23 pixel_by_point;
  const auto pixel = projectAlong(camera, ray, Vec3::Zero(), &pixel_by_point);
  const Mat2 by_offset = pixel_by_point * measurement.tangent_C;
  measurement.sqrt_information = by_offset / sigma_px;
  measurement.curvature = imageCurvature(camera, ray, measurement.tangent_C, by_offset) / sigma_px;
  Mat23 in_plane_by_ray;
  measurement.in_plane = placeInPlane(camera.model().plane, bearing_C, &in_plane_by_ray);
  measurement.in_plane_by_sigmas =
      in_plane_by_ray * measurement.tangent_C * measurement.sqrt_information.inverse();
  measurement.sigmas_per_px = 1.0 / sigma_px;
  Mat23 on_axis_by_point;
  const auto centre = camera.project(Vec3::UnitZ(), &on_axis_by_point);
  measurement.focal_lengths_sigmas = Vec2(on_axis_by_point(0, 0), on_axis_by_point(1, 1)) / sigma_px;
  if (pixel && centre) measurement.from_centre_sigmas = (*pixel - *centre) / sigma_px;
  return measurement;
}

Vec2 directionResidual(const DirectionMeasurement& measurement, const Vec3& point_C, Mat23* by_point) {
  const double depth = measurement.bearing_C.dot(point_C);
  if (depth < kMinCosine * point_C.norm()) {
    if (by_point) by_point->setZero();
    return Vec2::Constant(kOutlierResidual);
  }
  const Vec2 offset = measurement.tangent_C.transpose() * point_C / depth;
  const Quadratic quadratic(measurement.curvature, offset);
  if (by_point) {
    *by_point = (measurement.sqrt_information + quadratic.byOffset(measurement.curvature, offset)) *
                (measurement.tangent_C.transpose() - offset * measurement.bearing_C.transpose()) / depth;
  }
  return measurement.sqrt_information * offset + quadratic.value;
}

}  // namespace lodeline

#include "lodeline/frontend/stereo/triangulation.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

/// Parametrization by direction and inverse distance in the first view: the point is `origin + ray /
/// inverse_depth`.
struct FirstViewPoint {
  Vec3 origin_W;
  Vec3 ray_W;
  double inverse_depth = 0.0;

  /// Direction from `view` to the point times a positive factor; finite for points at infinity.
  Vec3 directionFrom(const BearingView& view) const {
    return view.world_from_camera.rotation.conjugate() *
           (ray_W + inverse_depth * (origin_W - view.world_from_camera.translation));
  }
};

double maxParallax(const std::vector<BearingView>& views) {
  double smallest_cosine = 1.0;
  for (size_t i = 0; i < views.size(); ++i) {
    const Vec3 first = views[i].world_from_camera.rotation * views[i].bearing_C;
    for (size_t j = i + 1; j < views.size(); ++j) {
      const Vec3 second = views[j].world_from_camera.rotation * views[j].bearing_C;
      smallest_cosine = std::min(smallest_cosine, first.dot(second));
    }
  }
  return std::acos(std::clamp(smallest_cosine, -1.0, 1.0));
}

FirstViewPoint startingPoint(const std::vector<BearingView>& views) {
  const Rigid3& first = views.front().world_from_camera;
  FirstViewPoint point{first.translation, first.rotation * views.front().bearing_C};
  // Solves bearing x (ray + inverse_depth * baseline) = 0 by least squares.
  double numerator = 0.0, denominator = 0.0;
  for (const BearingView& view : views) {
    const Vec3 bearing_W = view.world_from_camera.rotation * view.bearing_C;
    const Vec3 a = bearing_W.cross(first.translation - view.world_from_camera.translation);
    numerator -= a.dot(bearing_W.cross(point.ray_W));
    denominator += a.squaredNorm();
  }
  if (denominator > 0.0) point.inverse_depth = std::max(0.0, numerator / denominator);
  return point;
}

struct NormalEquations {
  Mat3 hessian = Mat3::Zero();
  Vec3 gradient = Vec3::Zero();
  double cost = 0.0;  ///< sum of squared whitened residuals
};

NormalEquations linearize(const std::vector<BearingView>& views, const FirstViewPoint& point,
                          const Mat32& ray_basis_W) {
  NormalEquations equations;
  for (const BearingView& view : views) {
    const Mat3 camera_from_world = view.world_from_camera.rotation.conjugate().toRotationMatrix();
    const Vec3 direction = point.directionFrom(view);
    const double length = direction.norm();
    const Vec3 unit = direction / length;
    const Mat32 across = tangentBasis(view.bearing_C);
    const Vec2 residual = across.transpose() * (unit - view.bearing_C) / view.sigma_rad;
    Mat3 direction_by_parameters;
    direction_by_parameters << camera_from_world * ray_basis_W,
        camera_from_world * (point.origin_W - view.world_from_camera.translation);
    const Mat23 jacobian = across.transpose() * (Mat3::Identity() - unit * unit.transpose()) *
                           direction_by_parameters / (length * view.sigma_rad);
    equations.hessian += jacobian.transpose() * jacobian;
    equations.gradient += jacobian.transpose() * residual;
    equations.cost += residual.squaredNorm();
  }
  return equations;
}

}  // namespace

Triangulation triangulate(const std::vector<BearingView>& views, const TriangulationOptions& options) {
  constexpr int kMaxIterations = 20;
  Triangulation result;
  if (views.size() < 2) return result;
  result.max_parallax_rad = maxParallax(views);

  FirstViewPoint point = startingPoint(views);
  // Keeps the inverse depth at its initial value where all views have the same position and do not determine
  // it.
  constexpr double kWeakest = 1e-9;
  NormalEquations equations;
  for (int i = 0; i < kMaxIterations; ++i) {
    const Mat32 basis = tangentBasis(point.ray_W);
    equations = linearize(views, point, basis);
    equations.hessian(2, 2) += kWeakest;
    const Vec3 step = -equations.hessian.ldlt().solve(equations.gradient);
    if (!step.allFinite()) break;
    const Vec3 moved = point.ray_W + basis * step.head<2>();
    point.inverse_depth = (point.inverse_depth + step.z()) / moved.norm();
    point.ray_W = moved.normalized();
    if (step.norm() < 1e-12) break;
  }

  result.inverse_depth_per_m = point.inverse_depth;
  result.inverse_depth_sigma_per_m = std::sqrt(equations.hessian.inverse()(2, 2));
  result.rms_sigmas = std::sqrt(equations.cost / static_cast<double>(2 * views.size()));
  if (point.inverse_depth > 0.0) result.point_W = point.origin_W + point.ray_W / point.inverse_depth;

  const bool in_front = std::all_of(views.begin(), views.end(), [&](const BearingView& view) {
    return point.directionFrom(view).dot(view.bearing_C) > 0.0;
  });
  if (result.max_parallax_rad < options.min_parallax_rad) {
    result.status = TriangulationStatus::LowParallax;
  } else if (!in_front || point.inverse_depth <= 0.0) {
    result.status = TriangulationStatus::BehindCamera;
  } else if (!(result.rms_sigmas <= options.max_rms_sigmas)) {
    result.status = TriangulationStatus::Inconsistent;
  } else {
    result.status = TriangulationStatus::Good;
  }
  return result;
}

const char* toString(TriangulationStatus status) {
  switch (status) {
    case TriangulationStatus::Good:
      return "good";
    case TriangulationStatus::TooFewViews:
      return "too few views";
    case TriangulationStatus::LowParallax:
      return "low parallax";
    case TriangulationStatus::BehindCamera:
      return "behind the camera";
    case TriangulationStatus::Inconsistent:
      return "inconsistent";
  }
  return "unknown";
}

}  // namespace lodeline

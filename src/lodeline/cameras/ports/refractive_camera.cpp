#include "lodeline/cameras/ports/refractive_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "lodeline/cameras/image_place.h"
#include "lodeline/cameras/port_camera.h"

namespace lodeline {

std::shared_ptr<const Camera> makeRefractiveCamera(const CameraCalibration& calibration,
                                                   std::shared_ptr<const Camera> in_air) {
  return std::make_shared<RefractiveCamera>(calibration, std::move(in_air));
}

RefractiveCamera::RefractiveCamera(const CameraCalibration& calibration, std::shared_ptr<const Camera> in_air)
    : Camera(calibration), in_air_(std::move(in_air)), port_(makePortRefraction(*calibration.port)) {
  max_angle_rad_ = widestAngle_rad();
}

std::optional<Vec2> RefractiveCamera::project(const Vec3& point_C, Mat23* pixel_by_point,
                                              PixelByParameters* pixel_by_parameters) const {
  Mat3 direction_by_point;
  const auto direction_C = port_->towards(point_C, pixel_by_point ? &direction_by_point : nullptr);
  if (!direction_C) return std::nullopt;
  const auto pixel = in_air_->project(*direction_C, pixel_by_point, pixel_by_parameters);
  if (pixel && pixel_by_point) *pixel_by_point *= direction_by_point;
  return pixel;
}

std::optional<Vec2> RefractiveCamera::projectByPort(const Vec3& point_C, PixelByPort* pixel_by_port) const {
  DirectionByPort direction_by_port;
  const auto direction_C = port_->towards(point_C, nullptr, &direction_by_port);
  if (!direction_C) return std::nullopt;
  Mat23 pixel_by_direction;
  const auto pixel = in_air_->project(*direction_C, &pixel_by_direction);
  if (pixel) *pixel_by_port = pixel_by_direction * direction_by_port;
  return pixel;
}

std::optional<Vec2> RefractiveCamera::projectHomogeneous(const Vec3& point_C, double inverse_scale) const {
  // At this distance, the size of a port is 1e-8 rad.
  constexpr double kFarthest_m = 1e7;
  return project(point_C / std::max(inverse_scale, 1.0 / kFarthest_m), nullptr, nullptr);
}

std::optional<ViewRay> RefractiveCamera::viewRay(const Vec2& pixel) const {
  const std::optional<Vec3> in_air_C = in_air_->unproject(pixel);
  return in_air_C ? port_->through(*in_air_C) : std::nullopt;
}

std::optional<Vec3> RefractiveCamera::unproject(const Vec2& pixel) const {
  const std::optional<Vec3> in_air_C = in_air_->unproject(pixel);
  return in_air_C ? nominalDirection(*in_air_C) : std::nullopt;
}

std::optional<Vec3> RefractiveCamera::nominalDirection(const Vec3& in_air_C) const {
  const std::optional<ViewRay> ray = port_->through(in_air_C);
  if (!ray) return std::nullopt;
  const double along_m = ray->origin_C.dot(ray->direction_C);
  const double rest =
      along_m * along_m - ray->origin_C.squaredNorm() + kNominalDistance_m * kNominalDistance_m;
  if (!(rest > 0.0)) return std::nullopt;
  const double length_m = std::sqrt(rest) - along_m;
  if (!(length_m > 0.0)) return std::nullopt;
  return (ray->origin_C + length_m * ray->direction_C).normalized();
}

double RefractiveCamera::widestAngle_rad() const {
  constexpr int kAround = 64, kHalvings = 40;
  double result = std::numbers::pi;
  for (int i = 0; i < kAround; ++i) {
    const double around = 2.0 * std::numbers::pi * i / kAround;
    // The largest angle in air at which light of this side passes the port.
    double low = 0.0, high = in_air_->maxAngle_rad();
    Vec3 last_C = Vec3::UnitZ();
    for (int k = 0; k < kHalvings; ++k) {
      const double angle = k == 0 ? high : 0.5 * (low + high);
      const Vec3 in_air_C(std::sin(angle) * std::cos(around), std::sin(angle) * std::sin(around),
                          std::cos(angle));
      const std::optional<Vec3> direction_C = nominalDirection(in_air_C);
      (direction_C ? low : high) = angle;
      if (direction_C) last_C = *direction_C;
      if (low == high) break;
    }
    result = std::min(result, std::acos(std::clamp(last_C.z(), -1.0, 1.0)));
  }
  // Between the sides that are compared, the angle may be slightly smaller.
  return result - kMarginToTheEnd_rad;
}

}  // namespace lodeline

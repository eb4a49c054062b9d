#include "simulation/rendering/optics/dome_port.h"

#include <cmath>

namespace lodeline {
namespace {

/// The point in which a ray from inside a sphere leaves it; nothing for a ray from outside.
std::optional<Vec3> exitOfSphere(const Vec3& origin, const Vec3& direction, const Vec3& centre,
                                 double radius_m) {
  const Vec3 offset = origin - centre;
  const double half = direction.dot(offset);
  const double inside = radius_m * radius_m - offset.squaredNorm();
  if (inside <= 0.0) return std::nullopt;
  return Vec3(origin + (std::sqrt(half * half + inside) - half) * direction);
}

}  // namespace

std::optional<WaterRay> throughPort(const DomePort& port, const Vec3& direction_air_C) {
  const Vec3 in_air = direction_air_C.normalized();
  const auto inner = exitOfSphere(Vec3::Zero(), in_air, port.centre_C, port.radius_m);
  if (!inner) return std::nullopt;
  const auto in_glass = refract(in_air, (*inner - port.centre_C).normalized(), 1.0 / port.index_glass);
  if (!in_glass) return std::nullopt;
  const auto outer = exitOfSphere(*inner, *in_glass, port.centre_C, port.radius_m + port.thickness_m);
  if (!outer) return std::nullopt;
  const auto in_water =
      refract(*in_glass, (*outer - port.centre_C).normalized(), port.index_glass / port.index_water);
  if (!in_water) return std::nullopt;
  return WaterRay{*outer, *in_water};
}

}  // namespace lodeline

#include "simulation/rendering/optics/flat_port.h"

#include <cmath>

namespace lodeline {

std::optional<Vec3> refract(const Vec3& direction, const Vec3& normal, double index_ratio) {
  const double cosine = direction.dot(normal);
  const double sine2 = index_ratio * index_ratio * (1.0 - cosine * cosine);
  if (cosine <= 0.0 || sine2 >= 1.0) return std::nullopt;
  return Vec3(index_ratio * direction + (std::sqrt(1.0 - sine2) - index_ratio * cosine) * normal)
      .normalized();
}

std::optional<WaterRay> throughPort(const FlatPort& port, const Vec3& direction_air_C) {
  const Vec3 normal = port.normal_C.normalized();
  const Vec3 in_air = direction_air_C.normalized();
  const auto in_glass = refract(in_air, normal, 1.0 / port.index_glass);
  if (!in_glass) return std::nullopt;
  const auto in_water = refract(*in_glass, normal, port.index_glass / port.index_water);
  if (!in_water) return std::nullopt;
  const Vec3 inner = port.distance_m / in_air.dot(normal) * in_air;
  return WaterRay{inner + port.thickness_m / in_glass->dot(normal) * *in_glass, *in_water};
}

}  // namespace lodeline

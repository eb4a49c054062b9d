#include "lodeline/cameras/ports/port_refraction.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "lodeline/cameras/port_camera.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

/// No plate may stand further aslant than this: its view would be to the side of the lens.
constexpr double kMinNormalCosine = 0.5;

std::string flatFault(const Port& port) {
  if (!port.normal_C.allFinite() || !(std::abs(port.normal_C.norm() - 1.0) < 1e-6))
    return "the normal of the flat port is no unit vector";
  if (port.normal_C.z() < kMinNormalCosine) {
    return fmt::format("the normal [{:g}, {:g}, {:g}] of the flat port points away from the view",
                       port.normal_C.x(), port.normal_C.y(), port.normal_C.z());
  }
  if (!std::isfinite(port.distance_m) || port.distance_m < 0.0)
    return fmt::format("distance_m of the flat port is {:g}; it must not be negative", port.distance_m);
  return {};
}

std::string domeFault(const Port& port) {
  if (!std::isfinite(port.radius_m) || port.radius_m <= 0.0)
    return fmt::format("radius_m of the dome port is {:g}; it must be positive", port.radius_m);
  const double offset_m = port.centre_C.norm();
  if (!(offset_m < port.radius_m)) {
    return fmt::format("the lens is {:g} m from the centre of the dome port of {:g} m radius, outside of it",
                       offset_m, port.radius_m);
  }
  return {};
}

}  // namespace

std::optional<Vec3> refractedDirection(const Vec3& direction, const Vec3& normal, double index_ratio) {
  const double cosine = direction.dot(normal);
  const double refracted_squared = 1.0 - index_ratio * index_ratio * (1.0 - cosine * cosine);
  if (!(cosine > 0.0) || !(refracted_squared > 0.0)) return std::nullopt;
  return (index_ratio * direction + (std::sqrt(refracted_squared) - index_ratio * cosine) * normal)
      .normalized();
}

Port correctedPort(Port port, const Vec3& change) {
  if (port.type == Port::Type::Dome) {
    port.centre_C += change;
  } else {
    port.normal_C = so3::exp(Vec3(change.x(), change.y(), 0.0)) * port.normal_C;
    port.distance_m += change.z();
  }
  return port;
}

std::unique_ptr<const PortRefraction> makePortRefraction(const Port& port) {
  return port.type == Port::Type::Flat ? makeFlatPort(port) : makeDomePort(port);
}

std::string portFault(const Port& port) {
  const std::array<std::pair<const char*, double>, 3> indices = {
      {{"air", port.index_air}, {"glass", port.index_glass}, {"water", port.index_water}}};
  for (const auto& [medium, index] : indices) {
    constexpr double kGreatest = 4.0;
    if (index >= 1.0 && index <= kGreatest) continue;
    return fmt::format("the refractive index of {} is {:g}; it must be from 1 to {:g}", medium, index,
                       kGreatest);
  }
  if (!std::isfinite(port.thickness_m) || port.thickness_m < 0.0)
    return fmt::format("thickness_m of the port is {:g}; it must not be negative", port.thickness_m);
  return port.type == Port::Type::Flat ? flatFault(port) : domeFault(port);
}

}  // namespace lodeline

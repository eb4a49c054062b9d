#include <fmt/core.h>

#include "lodeline/cameras/port_camera.h"
#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/camera_keys.h"

namespace lodeline {
namespace {

Port readFlatPort(CalibrationMap* map) {
  Port port;
  if (map->has("normal")) port.normal_C = map->vector3("normal");
  if (!port.normal_C.allFinite() || !(port.normal_C.norm() > 1e-9))
    throw InputError(map->atLine("normal") + " is no direction; a port square to the view has [0, 0, 1]");
  port.normal_C.normalize();
  port.distance_m = map->number("distance_m");
  return port;
}

Port readDomePort(CalibrationMap* map) {
  Port port;
  port.type = Port::Type::Dome;
  port.centre_C = map->vector3("centre_m");
  port.radius_m = map->number("radius_m");
  return port;
}

Port readPortOfType(CalibrationMap* map) {
  const std::string type = map->text("type");
  if (type == "flat") return readFlatPort(map);
  if (type == "dome") return readDomePort(map);
  throw InputError(fmt::format("{} is '{}'; it must be flat or dome", map->atLine("type"), type));
}

void readIndices(CalibrationMap* map, Port* port) {
  if (!map->has("indices")) return;
  const std::vector<double> indices = map->numbers("indices");
  if (indices.size() != 3) {
    throw InputError(fmt::format("{} has {} numbers; it needs those of air, glass and water",
                                 map->atLine("indices"), indices.size()));
  }
  port->index_air = indices[0];
  port->index_glass = indices[1];
  port->index_water = indices[2];
}

}  // namespace

std::optional<Port> readPort(CalibrationMap* camera) {
  std::optional<CalibrationMap> map = camera->section("port");
  if (!map) return std::nullopt;
  Port port = readPortOfType(&*map);
  port.thickness_m = map->number("thickness_m");
  readIndices(&*map, &port);
  map->refuseUnknownKeys();
  const std::string fault = portFault(port);
  if (!fault.empty()) throw InputError(fmt::format("{}: {}", camera->atLine("port"), fault));
  return port;
}

std::string portText(const Port& port) {
  const auto three = [](const Vec3& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); };
  const std::string place =
      port.type == Port::Type::Flat
          ? fmt::format("type: flat, normal: {}, distance_m: {}", three(port.normal_C), port.distance_m)
          : fmt::format("type: dome, centre_m: {}, radius_m: {}", three(port.centre_C), port.radius_m);
  return fmt::format("{{{}, thickness_m: {}, indices: [{}, {}, {}]}}", place, port.thickness_m,
                     port.index_air, port.index_glass, port.index_water);
}

}  // namespace lodeline

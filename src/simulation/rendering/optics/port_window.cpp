#include "simulation/rendering/optics/port_window.h"

namespace lodeline {

std::optional<WaterRay> throughPort(const PortWindow& port, const Vec3& direction_air_C) {
  return std::visit([&](const auto& shape) { return throughPort(shape, direction_air_C); }, port);
}

double waterIndex(const PortWindow& port) {
  return std::visit([](const auto& shape) { return shape.index_water; }, port);
}

double glassIndex(const PortWindow& port) {
  return std::visit([](const auto& shape) { return shape.index_glass; }, port);
}

PortWindow withIndices(PortWindow port, double index_glass, double index_water) {
  std::visit(
      [&](auto& shape) {
        shape.index_glass = index_glass;
        shape.index_water = index_water;
      },
      port);
  return port;
}

double enlargementBy(const PortWindow& port) {
  return std::holds_alternative<FlatPort>(port) ? waterIndex(port) : 1.0;
}

CameraCalibration airCameraFor(const CameraCalibration& in_water, const PortWindow& port) {
  CameraCalibration air = in_water;
  if (std::holds_alternative<DomePort>(port)) return air;
  air.fx_px /= waterIndex(port);
  air.fy_px /= waterIndex(port);
  air.model = "none";
  air.distortion.clear();
  return air;
}

}  // namespace lodeline

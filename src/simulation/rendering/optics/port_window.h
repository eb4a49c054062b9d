#pragma once

#include <variant>

#include "simulation/rendering/optics/dome_port.h"
#include "simulation/rendering/optics/flat_port.h"

namespace lodeline {

/// The window of a housing of either shape.
using PortWindow = std::variant<FlatPort, DomePort>;

std::optional<WaterRay> throughPort(const PortWindow& port, const Vec3& direction_air_C);

double waterIndex(const PortWindow& port);
double glassIndex(const PortWindow& port);

/// The same window for light or water of other refractive indices.
PortWindow withIndices(PortWindow port, double index_glass, double index_water);

/// Factor by which a port in water enlarges the image near the axis: the water's index behind a plate, 1
/// behind a dome.
double enlargementBy(const PortWindow& port);

/// The camera in air that, behind the port, has approximately the image of `in_water`. Behind a plate it has
/// smaller focal lengths and no distortion; behind a dome it is the same lens.
CameraCalibration airCameraFor(const CameraCalibration& in_water, const PortWindow& port);

}  // namespace lodeline

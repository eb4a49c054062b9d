#include "lodeline/mapping/control/files/control_positions.h"

#include <fmt/format.h>

#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>

namespace lodeline {
namespace {

PositionPrior priorAt(const Vec3& position, const ControlReadOptions::Sigmas& sigmas, const char* remedy) {
  if (!(position.norm() < kFarthestControl_m)) {
    throw InputError(
        fmt::format("is {:.0f} km from the origin of the map; {}", 1e-3 * position.norm(), remedy));
  }
  const Vec3 sigma(sigmas.horizontal_m, sigmas.horizontal_m, sigmas.vertical_m);
  return {position, Mat3(sigma.cwiseAbs2().asDiagonal())};
}

}  // namespace

PositionPrior onMap(const Vec3& grid_position, const ControlReadOptions& options,
                    const ControlReadOptions::Sigmas& sigmas) {
  return priorAt(grid_position - options.grid_origin.value_or(Vec3::Zero()), sigmas,
                 "state the coordinates of that origin on the grid of the file");
}

PositionPrior onMap(const GeodeticPosition& position, const ControlReadOptions& options,
                    const ControlReadOptions::Sigmas& sigmas) {
  if (!options.site) throw UsageError("positions in degrees need the site of the map: --site LAT,LON,HEIGHT");
  if (!(std::abs(position.latitude_deg) <= 90.0 && std::abs(position.longitude_deg) <= 180.0))
    throw InputError("is no latitude and longitude in degrees");
  const GeographicLib::LocalCartesian plane(options.site->latitude_deg, options.site->longitude_deg,
                                            options.site->height_m);
  Vec3 east_north_up;
  plane.Forward(position.latitude_deg, position.longitude_deg, position.height_m, east_north_up.x(),
                east_north_up.y(), east_north_up.z());
  return priorAt(east_north_up, sigmas, "check the site of the map, and the order of latitude and longitude");
}

}  // namespace lodeline

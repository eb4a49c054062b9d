#pragma once

#include <functional>

#include "simulation/dive/dive.h"
#include "simulation/rendering/cave/triangle_mesh.h"
#include "simulation/sensors/imu_model.h"

namespace lodeline {

/// Motion on transects; sets the floor around them in W.
Motion makeTransects(const Scenario& scenario, const Rigid3& vehicle_from_body, SeaFloorOptions* floor);

/// The hull of the scenario `wreck`: 40 x 12 m, open at both ends.
WreckLayout steelWreck();

/// Motion around and through a wreck, which is moved to W.
Motion makeWreckLaps(const Scenario& scenario, const Rigid3& vehicle_from_body, WreckLayout* wreck);

/// Adds thrusters, electric loads, the fields of the currents and of steel to a dive of a vehicle.
void equipVehicle(Dive& dive);

/// Floor or wreck of a vehicle's dive in W, as it is rendered.
TriangleMesh vehicleWorld(const Dive& dive);

/// Points on that surface near the path, 40 on a square metre. Plates have points on both sides.
LandmarkField vehicleLandmarks(const Dive& dive, const TriangleMesh& world);

/// Shakes a perfect reading by the thrusters' vibration, where the scenario has it; call it in order of time.
using Shaking = std::function<void(double time_s, ImuSample* reading)>;
Shaking makeShaking(const Dive& dive);

}  // namespace lodeline

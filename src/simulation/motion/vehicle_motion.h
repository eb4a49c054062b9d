#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "simulation/motion/posed_motion.h"
#include "simulation/shared/motion.h"

namespace lodeline {

/// A part of a vehicle's route, in axes of W from any origin. After it the vehicle hovers, and turns to the
/// heading of the next leg.
struct VehicleLeg {
  double length_m = 0.0;
  std::function<Vec3(double along_m)> position;
  std::function<double(double along_m)> yaw_rad;  ///< counter-clockwise from east
  double pause_s = 0.0;
};

struct VehicleMotionOptions {
  uint64_t seed = 1;
  double duration_s = 600.0;
  bool starts_at_rest = true;
  double start_rest_s = 4.0;
};

/// Motion of a vehicle along a route at an even speed: hovering, turns, small errors of its controller, and
/// pulls of the tether every 25 to 60 s that move it by 5 to 14 cm within half a second. Throws UsageError
/// where the speed is not 0.05 to 1.2 m/s.
Motion makeVehicleMotion(const std::vector<VehicleLeg>& route, const VehicleMotionOptions& options,
                         const Rigid3& vehicle_from_body);

/// Height of the ground at a place, m.
using GroundHeight = std::function<double(double east_m, double north_m)>;

/// Parallel transects of about 30 m, 1.5 m apart, at a constant altitude above the ground. In every third one
/// the vehicle hovers for 10 s. The path length is within 2 % of the requested one.
Motion makeTransectMotion(const GroundHeight& ground, double altitude_m, double path_length_m,
                          const VehicleMotionOptions& options, const Rigid3& vehicle_from_body);

/// Distance from the bow at which laps around a wreck begin and end, m.
constexpr double kWreckApproach_m = 15.0;

/// Laps of a vehicle: from outside to the bow, then in turn around the hull at 3.5 m, facing it, and through
/// it along its keel, and away. `path_length_m` cuts the last leg.
Motion makeWreckLapMotion(const WreckLayout& wreck, int laps, double path_length_m,
                          const VehicleMotionOptions& options, const Rigid3& vehicle_from_body);

/// Length of that route, m.
double wreckLapLength_m(const WreckLayout& wreck, int laps);

}  // namespace lodeline

#pragma once

#include "lodeline/simulation.h"
#include "simulation/dive/dive.h"
#include "simulation/dive/point_simulation.h"
#include "simulation/motion/dive_motion.h"
#include "simulation/plan/cave_plan.h"

namespace lodeline {

/// A world of points, a motion through it and the rig, as input of a PointSimulation; it must outlive that.
struct PointDive {
  MountedRig mounted;
  Centerline passage;  ///< first track of the route
  Motion motion;
  LandmarkField landmarks;
  /// Origin of the cave's frame in the world of the dive, m; the axes of both are east, north, up.
  Vec3 cave_origin_W = Vec3::Zero();

  PointSimulation simulate(const PointSimulationOptions& options) const {
    return PointSimulation(motion, landmarks, mounted.rig, options);
  }
};

/// Makes a dive with a passage of the length that the motion needs; both use `motion.seed`. The rig's IMU
/// calibration states the true noise of `imu`.
PointDive makePointDive(const DiveMotionOptions& motion, const MountedRig& mounted, const ImuErrors& imu);

/// Makes a dive in a planned cave: a circuit swum in laps, a junction, a chamber, or a passage in and out.
/// The cave with its points depends on `cave` alone. The motion depends on `motion.seed`; its path length is
/// that of the cave. Dives of one cave have the same points under the same indices
/// (PointSimulation::pointOf), each in its own world.
PointDive makeCaveDive(const CavePlanOptions& cave, const DiveMotionOptions& motion,
                       const MountedRig& mounted, const ImuErrors& imu);

/// A dive of a vehicle (scenario `auv` or `wreck`) with the points of its world; it must outlive its
/// simulations. Errors of the readings follow the effects of the scenario.
struct VehicleDive {
  Dive dive;
  LandmarkField landmarks;
  RangeFunction range;             ///< to the surface that the scenario renders
  PointSimulationOptions options;  ///< all errors and sensors; tracks and frames by default

  const Rig& trueRig() const { return dive.errors.in_water; }
  const Rig& givenRig() const { return dive.errors.given; }
  PointSimulation simulate() const { return simulate(options); }
  PointSimulation simulate(const PointSimulationOptions& changed) const;
};

VehicleDive makeVehicleDive(const Scenario& scenario);

}  // namespace lodeline

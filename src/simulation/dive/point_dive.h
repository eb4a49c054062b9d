#pragma once

#include "lodeline/simulation.h"
#include "simulation/dive/point_simulation.h"
#include "simulation/motion/dive_motion.h"

namespace lodeline {

/// A world of points, a motion through it and the rig, as input of a PointSimulation; it must outlive that.
struct PointDive {
  MountedRig mounted;
  Centerline passage;
  Motion motion;
  LandmarkField landmarks;

  PointSimulation simulate(const PointSimulationOptions& options) const {
    return PointSimulation(motion, landmarks, mounted.rig, options);
  }
};

/// Makes a dive with a passage of the length that the motion needs; both use `motion.seed`. The rig's IMU
/// calibration states the true noise of `imu`.
PointDive makePointDive(const DiveMotionOptions& motion, const MountedRig& mounted, const ImuErrors& imu);

}  // namespace lodeline

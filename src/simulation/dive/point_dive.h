#pragma once

#include "simulation/dive/point_simulation.h"
#include "simulation/motion/dive_motion.h"
#include "simulation/sensors/standard_rig.h"

namespace lodeline {

/// A world of points, a swim through it and the rig, ready for a PointSimulation; it must outlive that.
struct PointDive {
  MountedRig mounted;
  Centerline passage;
  Motion motion;
  LandmarkField landmarks;

  PointSimulation simulate(const PointSimulationOptions& options) const {
    return PointSimulation(motion, landmarks, mounted.rig, options);
  }
};

/// The passage is made as long as the swim needs; both take `motion.seed`. The rig's IMU calibration states
/// the noise of `imu`, so that an estimator that believes the rig believes the truth.
PointDive makePointDive(const DiveMotionOptions& motion, const MountedRig& mounted, const ImuErrors& imu);

}  // namespace lodeline

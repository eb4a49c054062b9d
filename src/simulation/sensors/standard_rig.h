#pragma once

#include "lodeline/sensors/rig.h"

namespace lodeline {

/// A rig with the way it is held: the diver frame D is x forward, y left, z up.
struct MountedRig {
  Rig rig;
  Rigid3 diver_from_body;
};

struct StandardRigOptions {
  int cameras = 2;
  int width_px = 640;
  int height_px = 480;
  double camera_rate_hz = 15.0;
  double imu_rate_hz = 200.0;
  double magnetometer_rate_hz = 50.0;
  double pressure_rate_hz = 2.0;
  double sonar_rate_hz = 20.0;
};

/// The hand-held rig of the simulator: cameras side by side with 14 cm of baseline looking ahead, 70 degrees
/// wide (as behind glass in water) with barrel distortion; the IMU between them upside down and turned; the
/// magnetometer inside the IMU; a pressure port behind; a sonar head below that scans across the view.
/// Extrinsics are a little off the drawing, as in any rig. IMU noise is left at its default.
MountedRig standardRig(const StandardRigOptions& options);

}  // namespace lodeline

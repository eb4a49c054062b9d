#pragma once

#include "lodeline/sensors/rig.h"

namespace lodeline {

/// A rig with its mounting in the diver frame D (x forward, y left, z up).
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
  /// Whether the sonar scans a horizontal sector of the view, and not all around across the view.
  bool sonar_scans_ahead = false;
};

/// The hand-held rig of the simulator. Its cameras are side by side with a baseline of 14 cm, look ahead, are
/// 70 degrees wide (as behind glass in water) and have barrel distortion. The IMU is between them, upside
/// down and rotated; the magnetometer is inside the IMU. A pressure port is behind, and a sonar head below
/// scans across the view, or the horizontal plane. As in any rig, the extrinsics differ a little from the
/// drawing. The IMU noise has its default.
MountedRig standardRig(const StandardRigOptions& options);

}  // namespace lodeline

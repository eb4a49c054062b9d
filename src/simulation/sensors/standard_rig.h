#pragma once

#include <string>

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
  /// Name of a camera model (cameras/camera_model.h). Empty: the radial-tangential lenses of the rig itself.
  std::string camera_model;
};

/// The hand-held rig of the simulator. Its cameras are side by side with a baseline of 14 cm, look ahead, are
/// 70 degrees wide (as behind glass in water) and have barrel distortion. The IMU is between them, upside
/// down and rotated; the magnetometer is inside the IMU. A pressure port is behind, and a sonar head below
/// scans across the view. As in any rig, the extrinsics differ a little from the drawing. The IMU noise has
/// its default. A `camera_model` gives both cameras that model's typical lens, with focal lengths 0.3 %
/// apart.
MountedRig standardRig(const StandardRigOptions& options);

}  // namespace lodeline

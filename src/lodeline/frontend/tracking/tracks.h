#pragma once

#include <cstdint>
#include <vector>

#include "lodeline/estimate.h"
#include "lodeline/types.h"

namespace lodeline {

/// One observation of a tracked point in one image.
struct FeatureObservation {
  TrackId track = -1;
  int camera = 0;                  ///< index into Rig::cameras
  Vec2 pixel = Vec2::Zero();       ///< in the image as recorded (distorted)
  Vec3 bearing_C = Vec3::UnitZ();  ///< unit ray in the camera frame
  double sigma_px = 1.0;           ///< standard deviation of the pixel along each axis
  /// Point of the ray next to the centre of the lens, m; away from it only behind a port.
  Vec3 origin_C = Vec3::Zero();
};

/// All observations of one time. Sorted by track, then camera; a track occurs at most once per camera.
struct FrameTracks {
  Time time;
  std::vector<FeatureObservation> observations = {};
  /// Rotation of camera 1, 2, ... relative to the rig's calibration, where their epipolar lines show a
  /// significant deviation: phi in rad, axes of camera 0; exp(phi) is multiplied on the left of the rotation
  /// of camera0_from_camera. Zero where the calibration may be correct; empty where nothing was compared.
  std::vector<Vec3> camera_rotations = {};
};

}  // namespace lodeline

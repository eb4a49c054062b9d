#pragma once

#include "lodeline/rig.h"

namespace lodeline {

/// A lens without distortion as calibrated in water, 640 x 480 px.
inline CameraCalibration lensInWater() {
  CameraCalibration camera;
  camera.name = "cam0";
  camera.width_px = 640;
  camera.height_px = 480;
  camera.fx_px = camera.fy_px = 450.0;
  camera.cx_px = 322.0;
  camera.cy_px = 239.0;
  return camera;
}

}  // namespace lodeline

#include "lodeline/rig_calibration/problem/rig_state.h"

#include "lodeline/cameras/port_camera.h"
#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {

CameraState::CameraState(const CameraCalibration& calibration)
    : base(calibration), lens{calibration.fx_px, calibration.fy_px, calibration.cx_px, calibration.cy_px} {
  lens.insert(lens.end(), calibration.distortion.begin(), calibration.distortion.end());
  poseToBlock(calibration.body_from_camera, body_from_camera.data());
  refresh();
}

CameraCalibration CameraState::calibration() const {
  CameraCalibration c = base;
  c.fx_px = lens[0];
  c.fy_px = lens[1];
  c.cx_px = lens[2];
  c.cy_px = lens[3];
  c.distortion.assign(lens.begin() + 4, lens.end());
  c.body_from_camera = poseFromBlock(body_from_camera.data());
  if (!c.port) return c;
  c.port = correctedPort(*c.port, Vec3(port.data()));
  c.port->index_water += port[3];
  return c;
}

void CameraState::refresh() {
  try {
    camera = makeCamera(calibration());
  } catch (const InputError&) {
    camera = nullptr;
  }
  behind_port = base.port ? dynamic_cast<const RefractiveCamera*>(camera.get()) : nullptr;
}

Quat RigState::worldFromBoard() const {
  return (so3::exp(Vec3(tilt[0], tilt[1], 0.0)) * level_from_board).normalized();
}

}  // namespace lodeline

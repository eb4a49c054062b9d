#include "lodeline/simulation.h"

#include <fmt/core.h>

#include <numbers>

#include "lodeline/cameras/camera_model.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

// Columns: the camera's x (right), y (down) and z (ahead) in D.
Quat diverFromCamera() {
  Mat3 rotation;
  rotation << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  return Quat(rotation);
}

// The sonar rotates its beam in its x-y plane: across the view, x to the left; or through the view, x ahead.
Quat diverFromSonar(bool scans_ahead) {
  if (scans_ahead) return Quat::Identity();
  Mat3 rotation;
  rotation << 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0;
  return Quat(rotation);
}

/// Replaces the lens by the typical one of a camera model.
void setTypicalLens(const CameraModel& model, int index, CameraCalibration* calibration) {
  const double on_axis_px =
      model.typical.focal_length_share * calibration->width_px * (index == 0 ? 1.0 : 1.003);
  calibration->model = model.name;
  calibration->distortion = model.typical.parameters;
  calibration->fx_px = calibration->fy_px = on_axis_px;
  const double unscaled_px = focalLengthOnAxis_px(*calibration);
  calibration->fx_px = on_axis_px * on_axis_px / unscaled_px;
  calibration->fy_px = 0.999 * calibration->fx_px;
}

CameraCalibration camera(const StandardRigOptions& o, int index) {
  CameraCalibration calibration;
  calibration.name = fmt::format("cam{}", index);
  calibration.width_px = o.width_px;
  calibration.height_px = o.height_px;
  const double scale = o.width_px / 640.0;
  calibration.fx_px = (index == 0 ? 457.3 : 458.9) * scale;
  calibration.fy_px = (index == 0 ? 456.8 : 458.1) * scale;
  calibration.cx_px = 0.5 * o.width_px + (index == 0 ? 3.2 : -4.7) * scale;
  calibration.cy_px = 0.5 * o.height_px + (index == 0 ? -5.1 : 2.4) * scale;
  calibration.model = "radial-tangential";
  calibration.distortion = index == 0 ? std::vector<double>{-0.172, 0.058, 3e-4, -2e-4}
                                      : std::vector<double>{-0.175, 0.060, -1e-4, 3e-4};
  calibration.rate_hz = o.camera_rate_hz;
  if (const CameraModel* model = findCameraModel(o.camera_model)) setTypicalLens(*model, index, &calibration);
  return calibration;
}

}  // namespace

MountedRig standardRig(const StandardRigOptions& o) {
  MountedRig mounted;
  const Quat upside_down_and_turned(Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitX()) *
                                    Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitZ()));
  mounted.diver_from_body =
      Rigid3(upside_down_and_turned * so3::exp(kDegree * Vec3(0.7, -1.1, 0.4)), Vec3(0.02, 0.015, -0.05));
  const Rigid3 body_from_diver = mounted.diver_from_body.inverse();

  for (int i = 0; i < o.cameras; ++i) {
    CameraCalibration calibration = camera(o, i);
    const Vec3 misalignment = i == 0 ? Vec3(0.3, -0.2, 0.1) : Vec3(-0.2, 0.4, 0.3);
    calibration.body_from_camera =
        body_from_diver * Rigid3(diverFromCamera() * so3::exp(kDegree * misalignment),
                                 Vec3(0.10, i == 0 ? 0.07 : 0.07 - 0.14 * i, i == 0 ? 0.0 : 0.0006));
    mounted.rig.cameras.push_back(calibration);
  }
  mounted.rig.imu.rate_hz = o.imu_rate_hz;
  mounted.rig.magnetometer = MagnetometerCalibration{o.magnetometer_rate_hz, 1e-8, Rigid3()};
  mounted.rig.pressure = PressureCalibration{
      o.pressure_rate_hz, 0.02, body_from_diver * Rigid3(Quat::Identity(), Vec3(-0.12, 0.0, 0.03))};
  mounted.rig.sonar =
      SonarCalibration{o.sonar_rate_hz, 0.03,
                       body_from_diver * Rigid3(diverFromSonar(o.sonar_scans_ahead), Vec3(0.05, 0.0, -0.12))};
  return mounted;
}

}  // namespace lodeline

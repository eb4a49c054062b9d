#include <fmt/core.h>

#include "lodeline/geometry/so3.h"
#include "lodeline/simulation.h"
#include "lodeline/util/angles.h"
#include "simulation/vehicle/vehicle_currents.h"

namespace lodeline {
namespace {

// The axes of D in a sensor's frame that looks down: x ahead, y to the right, z down.
Quat looksDown() { return Quat(0.0, 1.0, 0.0, 0.0); }

// A beam along x that points down.
Quat beamDown() { return Quat(Eigen::AngleAxisd(90.0 * kDegree, Vec3::UnitY())); }

}  // namespace

MountedRig vehicleRig(const StandardRigOptions& o) {
  // Lenses, and the rates of the sensors that a diver's rig has as well.
  const MountedRig hand_held = standardRig(o);
  MountedRig mounted;
  mounted.diver_from_body = Rigid3(so3::exp(kDegree * Vec3(0.8, -0.5, 1.2)), Vec3(0.02, -0.01, 0.03));
  const Rigid3 body_from_vehicle = mounted.diver_from_body.inverse();
  mounted.rig = hand_held.rig;
  const Quat tilt(Eigen::AngleAxisd(o.camera_tilt_rad, Vec3::UnitY()));
  for (CameraCalibration& camera : mounted.rig.cameras) {
    // The pose in D of the hand-held rig, turned down and moved to the front of the vehicle.
    const Rigid3 vehicle_from_camera = hand_held.diver_from_body * camera.body_from_camera;
    const double left_m =
        vehicle_from_camera.translation.y() - (mounted.rig.cameras.size() == 1 ? 0.07 : 0.0);
    camera.body_from_camera = body_from_vehicle * Rigid3((tilt * vehicle_from_camera.rotation).normalized(),
                                                         Vec3(0.24, left_m, -0.05));
  }
  mounted.rig.pressure->body_from_pressure =
      body_from_vehicle * Rigid3(Quat::Identity(), Vec3(-0.20, 0.0, 0.02));
  mounted.rig.sonar->body_from_sonar =
      body_from_vehicle * Rigid3((hand_held.diver_from_body * hand_held.rig.sonar->body_from_sonar).rotation,
                                 Vec3(0.18, 0.0, -0.14));
  SonarCalibration altimeter;
  altimeter.rate_hz = o.altimeter_rate_hz;
  altimeter.range_noise_std_m = 0.03;
  altimeter.body_from_sonar = body_from_vehicle * Rigid3(beamDown(), Vec3(0.05, 0.12, -0.15));
  altimeter.max_range_m = 50.0;
  mounted.rig.altimeter = altimeter;
  DvlCalibration dvl;
  dvl.rate_hz = o.dvl_rate_hz;
  dvl.body_from_dvl = body_from_vehicle * Rigid3(looksDown(), Vec3(-0.15, 0.0, -0.16));
  mounted.rig.dvl = dvl;
  CurrentCalibration currents;
  currents.rate_hz = o.current_rate_hz;
  currents.channels = currentChannels();
  mounted.rig.currents = currents;
  return mounted;
}

}  // namespace lodeline

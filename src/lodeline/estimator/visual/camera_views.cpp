#include "lodeline/estimator/visual/camera_views.h"

#include <utility>

#include "lodeline/geometry/so3.h"

namespace lodeline {
CameraViews::CameraViews(const Window& window, const CameraStates& states, const FactorBuilder& factors,
                         At at, std::vector<int> hosts)
    : window_(window),
      states_(states),
      factors_(factors),
      at_(at),
      frames_(static_cast<int>(window.frames().size())),
      cameras_(factors.cameraCount()),
      hosts_(std::move(hosts)),
      placements_(window.frames().size()),
      secondary_(static_cast<size_t>(cameras_) - 1),
      relative_(static_cast<size_t>(frames_ * frames_ * cameras_)) {}

void CameraViews::update() {
  for (int i = 0; i < frames_; ++i)
    placements_[static_cast<size_t>(i)] = placeFrame(*window_.frames()[static_cast<size_t>(i)]);
  for (int camera = 1; camera < cameras_; ++camera)
    secondary_[static_cast<size_t>(camera) - 1] = placeFurther(camera);
  for (const int host : hosts_) {
    for (int target = 0; target < frames_; ++target) relate(host, target);
  }
}

const double* CameraViews::valueOf(const ParameterBlock& state) const {
  return at_ == At::kLinearizationPoints && state.first ? state.first->data() : state.value.data();
}

CameraViews::Placement CameraViews::placeFrame(const Frame& frame) const {
  const double* pose =
      at_ == At::kLinearizationPoints && frame.first_pose ? frame.first_pose->data() : frame.pose.data();
  Rigid3 world_from_body = poseFromBlock(pose);
  Rigid3 body_from_camera = factors_.bodyFromCamera(0);
  Placement placement;
  placement.by_calibration.setZero();
  if (states_) {
    const double* correction = valueOf(*states_.camera0);
    world_from_body = frame.image_motion.poseAfter(world_from_body, *valueOf(*states_.time_offset));
    body_from_camera = correctedExtrinsics(body_from_camera, correction);
    const Mat3 rotation = world_from_body.rotation.toRotationMatrix();
    const Vec3 turning_W = rotation * frame.image_motion.angular_velocity_B;
    placement.by_calibration.block<3, 3>(3, 0) = rotation * so3::leftJacobian(Vec3(correction));
    placement.by_calibration.block<3, 3>(0, 3) = rotation;
    placement.by_calibration.col(6) << frame.image_motion.velocity_W +
                                           turning_W.cross(rotation * body_from_camera.translation),
        turning_W;
  }
  const Vec3 arm_W = world_from_body.rotation * body_from_camera.translation;
  placement.world_from_camera = (world_from_body.rotation * body_from_camera.rotation).toRotationMatrix();
  placement.position_W = world_from_body.translation + arm_W;
  placement.by_body.setIdentity();
  placement.by_body.topRightCorner<3, 3>() = -so3::skew(arm_W);
  return placement;
}

CameraViews::Further CameraViews::placeFurther(int camera) const {
  Rigid3 camera0_from_camera = factors_.camera0FromCamera(camera);
  Further secondary;
  secondary.left_jacobian.setIdentity();
  if (states_) {
    const double* correction = valueOf(*states_.secondary[static_cast<size_t>(camera) - 1]);
    camera0_from_camera = correctedExtrinsics(camera0_from_camera, correction);
    secondary.left_jacobian = so3::leftJacobian(Vec3(correction));
  }
  secondary.camera0_from_camera = camera0_from_camera.rotation.toRotationMatrix();
  secondary.position_C0 = camera0_from_camera.translation;
  return secondary;
}

void CameraViews::relate(int host, int target) {
  Relative* relative = &relative_[static_cast<size_t>((host * frames_ + target) * cameras_)];
  if (host == target) {
    *relative = {Mat3::Identity(), Vec3::Zero()};
  } else {
    const Placement& from = placement(host);
    const Placement& to = placement(target);
    relative->rotation = to.world_from_camera.transpose() * from.world_from_camera;
    relative->translation = to.world_from_camera.transpose() * (from.position_W - to.position_W);
  }
  for (int camera = 1; camera < cameras_; ++camera) {
    const Mat3 camera_from_camera0 = secondary(camera).camera0_from_camera.transpose();
    relative[camera] = {camera_from_camera0 * relative->rotation,
                        camera_from_camera0 * (relative->translation - secondary(camera).position_C0)};
  }
}

}  // namespace lodeline

#include "lodeline/estimator/camera_states.h"

#include <gtest/gtest.h>

#include "lodeline/estimator/test_scene.h"
#include "lodeline/factors/calibrated_reprojection_factor.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

TestSceneOptions sceneOptions() {
  TestSceneOptions options;
  options.cameras = 2;
  options.duration_s = 20.0;
  options.points.frame_rate_hz = 10.0;
  options.points.tracks = 60;
  return options;
}

/// The estimator's last word on a scene, with the calibration files it was given.
FrameEstimate lastEstimate(TestScene& scene, const Rig& files, const EstimatorOptions& options) {
  Diagnostics diagnostics;
  Estimator estimator(files, options, &diagnostics);
  FrameEstimate last;
  while (const auto frame = scene.next()) last = estimator.add(frame->tracks, frame->imu);
  return last;
}

TEST(CameraStates, FindWrongExtrinsics) {
  TestScene scene(sceneOptions());
  Rig files = scene.rig();
  const Vec3 rotation(0.008, -0.012, 0.01);  // 1 degree
  const Vec3 position(0.012, -0.01, 0.012);  // 2 cm
  for (CameraCalibration& camera : files.cameras) {
    camera.body_from_camera.rotation = so3::exp(rotation) * camera.body_from_camera.rotation;
    camera.body_from_camera.translation += position;
  }
  // Both cameras moved alike: what is right between them stays right.
  files.cameras[1].body_from_camera =
      files.cameras[0].body_from_camera *
      (scene.rig().cameras[0].body_from_camera.inverse() * scene.rig().cameras[1].body_from_camera);
  const FrameEstimate last = lastEstimate(scene, files, honestOptions(sceneOptions()));
  ASSERT_TRUE(last.camera_corrections);
  const Rigid3 found =
      correctedExtrinsics(files.cameras[0].body_from_camera, last.camera_corrections->extrinsics[0].data());
  const Rigid3& truth = scene.rig().cameras[0].body_from_camera;
  EXPECT_LT(so3::log(found.rotation * truth.rotation.conjugate()).norm(), 0.1 * rotation.norm());
  // The place of the camera shows in turns alone, and slowly.
  EXPECT_LT((found.translation - truth.translation).norm(), 0.7 * position.norm());
  EXPECT_LT(std::abs(last.camera_corrections->time_offset_s), 1e-3);
}

TEST(CameraStates, FindAWrongStereoRotation) {
  TestScene scene(sceneOptions());
  Rig files = scene.rig();
  const Vec3 rotation(0.002, -0.0015, 0.001);
  files.cameras[1].body_from_camera.rotation =
      files.cameras[1].body_from_camera.rotation * so3::exp(rotation);
  const FrameEstimate last = lastEstimate(scene, files, honestOptions(sceneOptions()));
  ASSERT_TRUE(last.camera_corrections);
  ASSERT_EQ(last.camera_corrections->extrinsics.size(), 2U);
  const Rigid3 camera0_from_camera1 =
      correctedExtrinsics(files.cameras[0].body_from_camera.inverse() * files.cameras[1].body_from_camera,
                          last.camera_corrections->extrinsics[1].data());
  const Rigid3 truth =
      scene.rig().cameras[0].body_from_camera.inverse() * scene.rig().cameras[1].body_from_camera;
  EXPECT_LT(so3::log(camera0_from_camera1.rotation * truth.rotation.conjugate()).norm(),
            0.15 * rotation.norm());
}

TEST(CameraStates, StayNearARightCalibration) {
  TestScene scene(sceneOptions());
  const FrameEstimate last = lastEstimate(scene, scene.rig(), honestOptions(sceneOptions()));
  ASSERT_TRUE(last.camera_corrections);
  EXPECT_LT(last.camera_corrections->extrinsics[0].head<3>().norm(), 2e-3);
  EXPECT_LT(last.camera_corrections->extrinsics[1].head<3>().norm(), 3e-4);
  EXPECT_LT(std::abs(last.camera_corrections->time_offset_s), 1e-3);
}

TEST(CameraStates, AreHeldByASigmaOfZeroAndAbsentWhenOff) {
  EstimatorOptions options = honestOptions(sceneOptions());
  options.camera_calibration = {true, 0.0, 0.0, 0.0, 0.0, 0.0};
  TestSceneOptions shorter = sceneOptions();
  shorter.duration_s = 6.0;
  TestScene held_scene(shorter);
  const FrameEstimate held = lastEstimate(held_scene, held_scene.rig(), options);
  ASSERT_TRUE(held.camera_corrections);
  EXPECT_LT(held.camera_corrections->extrinsics[0].norm(), 1e-5);
  EXPECT_LT(std::abs(held.camera_corrections->time_offset_s), 1e-5);

  options.camera_calibration.enabled = false;
  TestScene off_scene(shorter);
  const FrameEstimate off = lastEstimate(off_scene, off_scene.rig(), options);
  EXPECT_FALSE(off.camera_corrections);
  EXPECT_LT((held.state.world_from_body.translation - off.state.world_from_body.translation).norm(), 1e-4);
}

}  // namespace
}  // namespace lodeline

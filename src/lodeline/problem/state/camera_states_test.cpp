#include "lodeline/problem/state/camera_states.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "lodeline/cameras/camera.h"
#include "lodeline/estimator/trials/dive_consistency.h"
#include "lodeline/estimator/trials/scene.h"
#include "lodeline/factors/calibrated_reprojection_factor.h"
#include "lodeline/factors/intrinsics_factor.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

TestSceneOptions sceneOptions(uint64_t seed = 1) {
  TestSceneOptions options;
  options.seed = seed;
  options.cameras = 2;
  options.duration_s = 20.0;
  options.points.frame_rate_hz = 10.0;
  options.points.tracks = 60;
  return options;
}

/// Last estimate of a scene with the given calibration files.
FrameEstimate lastEstimate(TestScene& scene, const Rig& files, const EstimatorOptions& options) {
  Diagnostics diagnostics;
  Estimator estimator(files, options, &diagnostics);
  FrameEstimate last;
  while (const auto frame = scene.next()) last = estimator.add(frame->tracks, frame->imu);
  return last;
}

/// Final error of camera 0's estimated extrinsics when both cameras' files are moved by `moved`.
Rigid3 errorOfExtrinsics(const Rigid3& moved, uint64_t seed) {
  TestScene scene(sceneOptions(seed));
  Rig files = scene.rig();
  for (CameraCalibration& camera : files.cameras) {
    camera.body_from_camera.rotation = moved.rotation * camera.body_from_camera.rotation;
    camera.body_from_camera.translation += moved.translation;
  }
  // Both cameras move together: their relative pose stays correct.
  files.cameras[1].body_from_camera =
      files.cameras[0].body_from_camera *
      (scene.rig().cameras[0].body_from_camera.inverse() * scene.rig().cameras[1].body_from_camera);
  const FrameEstimate last = lastEstimate(scene, files, honestOptions(sceneOptions(seed)));
  const CameraCorrections& corrections = last.camera_corrections.value();
  EXPECT_LT(std::abs(corrections.time_offset_s), 1e-3);
  const Rigid3 found =
      correctedExtrinsics(files.cameras[0].body_from_camera, corrections.extrinsics[0].data());
  const Rigid3& truth = scene.rig().cameras[0].body_from_camera;
  return Rigid3(found.rotation * truth.rotation.conjugate(), found.translation - truth.translation);
}

TEST(CameraStates, FindWrongExtrinsics) {
  constexpr uint64_t kSeeds = 6;
  const Rigid3 moved(so3::exp(Vec3(0.008, -0.012, 0.01)), Vec3(0.012, -0.01, 0.012));  // 1 degree, 2 cm
  double squares_m2 = 0.0;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Rigid3 error = errorOfExtrinsics(moved, seed);
    EXPECT_LT(so3::log(error.rotation).norm(), 0.1 * so3::log(moved.rotation).norm()) << seed;
    squares_m2 += error.translation.squaredNorm() / kSeeds;
  }
  // The camera's position is observable only in rotations, and slowly.
  EXPECT_LT(std::sqrt(squares_m2), 0.7 * moved.translation.norm());
}

/// Error that remains of a wrong rotation of the second camera, as a share of it. The lenses are symmetric.
double restOfStereoRotation(bool lenses) {
  TestScene scene(sceneOptions());
  Rig files = scene.rig();
  const Vec3 rotation(0.002, -0.0015, 0.001);
  files.cameras[1].body_from_camera.rotation =
      files.cameras[1].body_from_camera.rotation * so3::exp(rotation);
  EstimatorOptions options = honestOptions(sceneOptions());
  options.camera_calibration.intrinsics = lenses;
  options.camera_calibration.tangential_sigma = options.camera_calibration.port_tilt_sigma = 0.0;
  const FrameEstimate last = lastEstimate(scene, files, options);
  const Rigid3 camera0_from_camera1 =
      correctedExtrinsics(files.cameras[0].body_from_camera.inverse() * files.cameras[1].body_from_camera,
                          last.camera_corrections.value().extrinsics.at(1).data());
  const Rigid3 truth =
      scene.rig().cameras[0].body_from_camera.inverse() * scene.rig().cameras[1].body_from_camera;
  return so3::log(camera0_from_camera1.rotation * truth.rotation.conjugate()).norm() / rotation.norm();
}

TEST(CameraStates, FindAWrongStereoRotation) {
  EXPECT_LT(restOfStereoRotation(false), 0.15);
  EXPECT_LT(restOfStereoRotation(true), 0.15);
}

/// Options for files with larger errors than usual.
CameraCalibrationOptions calibrationOfWrongFiles(bool lenses) {
  CameraCalibrationOptions options;
  options.intrinsics = lenses;
  options.focal_length_sigma = 0.005;
  options.principal_point_sigma_px = 2.0;
  options.radial_sigma = 0.01;
  return options;
}

/// Interprets the tracks of a scene with the cameras of other files.
class TracksReadWith {
 public:
  TracksReadWith(const Rig& files, const Rig& truth) {
    for (const CameraCalibration& camera : files.cameras) files_.push_back(makeCamera(camera));
    for (const CameraCalibration& camera : truth.cameras) truth_.push_back(makeCamera(camera));
  }

  FrameTracks operator()(FrameTracks tracks) const {
    for (FeatureObservation& observation : tracks.observations) {
      const auto camera = static_cast<size_t>(observation.camera);
      observation.bearing_C = *files_[camera]->unproject(*truth_[camera]->project(observation.bearing_C));
    }
    return tracks;
  }

 private:
  std::vector<std::shared_ptr<const Camera>> files_, truth_;
};

/// Mean squared distance from the truth over the whole scene; `last` receives the last estimate.
double squaredPositionError_m2(bool lenses, uint64_t seed, const IntrinsicsCorrection& lens,
                               FrameEstimate* last) {
  TestSceneOptions scene_options = sceneOptions();
  scene_options.seed = seed;
  scene_options.duration_s = 60.0;  // after 20 s focal lengths are known to 0.001, one eighth of the error
  TestScene scene(scene_options);
  Rig files = scene.rig();
  const IntrinsicsCorrection undone = -lens;
  for (CameraCalibration& camera : files.cameras) camera = correctedIntrinsics(camera, undone.data());
  EstimatorOptions options = honestOptions(scene_options);
  options.camera_calibration = calibrationOfWrongFiles(lenses);
  Diagnostics diagnostics;
  Estimator estimator(files, options, &diagnostics);
  TruthComparison truth;
  double squares = 0.0;
  int frames = 0;
  const TracksReadWith read(files, scene.rig());
  while (const auto frame = scene.next()) {
    *last = estimator.add(read(frame->tracks), frame->imu);
    const Comparison compared = truth.compare(*frame, *last, estimator);
    if (!compared.initialized()) continue;
    squares += compared.positionError() * compared.positionError();
    ++frames;
  }
  return squares / frames;
}

TEST(CameraStates, FindAWrongLens) {
  IntrinsicsCorrection lens = IntrinsicsCorrection::Zero();
  lens.head<4>() << 0.008, 0.006, 3.0, -2.0;
  FrameEstimate held, found;
  const double held_m2 = squaredPositionError_m2(false, 1, lens, &held);
  const double found_m2 = squaredPositionError_m2(true, 1, lens, &found);
  EXPECT_TRUE(held.camera_corrections->intrinsics.empty());
  ASSERT_EQ(found.camera_corrections->intrinsics.size(), 2U);
  for (const auto& estimate : found.camera_corrections->intrinsics) {
    EXPECT_LT((estimate - lens).head<2>().norm(), 0.3 * lens.head<2>().norm()) << estimate.transpose();
    EXPECT_LT((estimate - lens).segment<2>(2).norm(), 0.5 * lens.segment<2>(2).norm())
        << estimate.transpose();
  }
  EXPECT_LT(found_m2, 0.5 * held_m2);
}

TEST(CameraStates, TakeAWrongProfileForNoLongerLens) {
  IntrinsicsCorrection lens = IntrinsicsCorrection::Zero();
  lens.segment<2>(4) << 0.012, -0.02;
  double held_m2 = 0.0, found_m2 = 0.0;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    FrameEstimate held, found;
    held_m2 += squaredPositionError_m2(false, seed, lens, &held);
    found_m2 += squaredPositionError_m2(true, seed, lens, &found);
    for (const auto& estimate : found.camera_corrections->intrinsics) {
      EXPECT_LT((estimate - lens).segment<2>(4).norm(), 0.3 * lens.segment<2>(4).norm())
          << estimate.transpose();
      EXPECT_LT(estimate.head<2>().cwiseAbs().maxCoeff(), 0.0025) << estimate.transpose();
    }
  }
  EXPECT_LT(found_m2, 0.25 * held_m2);
}

// Such a lens turns the heading with every metre.
TEST(CameraStates, FindALensThatIsNotSymmetric) {
  IntrinsicsCorrection lens = IntrinsicsCorrection::Zero();
  lens.segment<2>(6) << 0.004, -0.003;
  FrameEstimate held, found;
  const double held_m2 = squaredPositionError_m2(false, 1, lens, &held);
  const double found_m2 = squaredPositionError_m2(true, 1, lens, &found);
  for (const auto& estimate : found.camera_corrections->intrinsics)
    EXPECT_LT((estimate - lens).segment<2>(6).norm(), 0.3 * lens.norm()) << estimate.transpose();
  EXPECT_LT(found_m2, 0.5 * held_m2);
}

TEST(CameraStates, StayNearARightLens) {
  FrameEstimate last;
  squaredPositionError_m2(true, 1, IntrinsicsCorrection::Zero(), &last);
  for (const auto& estimate : last.camera_corrections->intrinsics) {
    const CameraCalibrationOptions prior = calibrationOfWrongFiles(true);
    EXPECT_LT(estimate.head<2>().cwiseAbs().maxCoeff(), prior.focal_length_sigma) << estimate.transpose();
    EXPECT_LT(estimate.segment<2>(2).cwiseAbs().maxCoeff(), prior.principal_point_sigma_px)
        << estimate.transpose();
  }
}

TEST(CameraStates, HoldTheLensUntilTheWindowHasSettled) {
  for (const int cameras : {1, 2}) {
    TestSceneOptions wanted = sceneOptions();
    wanted.cameras = cameras;
    TestScene scene(wanted);
    const EstimatorOptions options = honestOptions(wanted);
    Diagnostics diagnostics;
    Estimator estimator(scene.rig(), options, &diagnostics);
    int frames = 0, freed_at = 0;
    size_t lenses = 0;
    while (const auto frame = scene.next()) {
      const FrameEstimate estimate = estimator.add(frame->tracks, frame->imu);
      if (estimate.camera_corrections) lenses = estimate.camera_corrections->intrinsics.size();
      ++frames;
      if (lenses > 0 && freed_at == 0) freed_at = frames;
    }
    EXPECT_GE(freed_at, cameras == 1 ? options.window.startup_frames_mono : options.window.startup_frames);
    EXPECT_EQ(lenses, static_cast<size_t>(cameras));
  }
}

TEST(CameraStates, StayNearARightCalibration) {
  TestScene scene(sceneOptions());
  const FrameEstimate last = lastEstimate(scene, scene.rig(), honestOptions(sceneOptions()));
  ASSERT_TRUE(last.camera_corrections);
  EXPECT_LT(last.camera_corrections->extrinsics[0].head<3>().norm(), 2e-3);
  EXPECT_LT(last.camera_corrections->extrinsics[1].head<3>().norm(), 3e-4);
  EXPECT_LT(std::abs(last.camera_corrections->time_offset_s), 1e-3);
}

TEST(CameraStates, StartWhereTheFrontEndFoundACamera) {
  const Vec3 turn(0.014, 0.0, -0.007);
  Window window;
  Prior prior;
  addCameraStates(window, prior, 3, {}, {turn});
  const std::optional<CameraCorrections> corrections = cameraCorrections(window);
  ASSERT_TRUE(corrections);
  ASSERT_EQ(corrections->extrinsics.size(), 3u);
  EXPECT_TRUE(corrections->extrinsics[0].isZero());
  EXPECT_EQ(Vec3(corrections->extrinsics[1].head<3>()), turn);
  EXPECT_TRUE(corrections->extrinsics[2].isZero());
  // The prior is centred there.
  const Eigen::VectorXd known = prior.blocks[2].linearization_point;
  EXPECT_EQ(Vec3(known.head<3>()), turn);
}

TEST(CameraStates, AreHeldByASigmaOfZeroAndAbsentWhenOff) {
  EstimatorOptions options = honestOptions(sceneOptions());
  options.camera_calibration = {true, 0.0, 0.0, 0.0, 0.0, 0.0, true, 0.0, 0.0, 0.0, 0.0, 0.0};
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

// Observations with half a pixel of noise must not bias the focal length. The bias of one observation would
// be small, but it would have the same sign in all.
TEST(CameraStates, NoiseMakesNoLensLonger) {
  constexpr int kDives = 3;
  double mean = 0.0;
  for (int seed = 1; seed <= kDives; ++seed) {
    HeadingTrialOptions dive = exactDive(120.0);
    dive.seed = static_cast<uint64_t>(seed);
    dive.estimator.camera_calibration.enabled = true;
    std::optional<CameraCorrections> corrections;
    runTrialDive(dive, [&](const SimulatedFrame&, const FrameEstimate& estimate, const Estimator&) {
      corrections = estimate.camera_corrections;
    });
    ASSERT_TRUE(corrections && !corrections->intrinsics.empty());
    mean += 0.5 * corrections->intrinsics[0].head<2>().sum() / kDives;
  }
  // One dive determines the focal length with a sigma of 0.0004.
  EXPECT_NEAR(mean, 0.0, 1e-3);
}

}  // namespace
}  // namespace lodeline

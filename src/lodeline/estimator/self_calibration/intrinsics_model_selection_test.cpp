#include "lodeline/estimator/self_calibration/intrinsics_model_selection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/cameras/camera.h"
#include "lodeline/estimator/estimator.h"
#include "lodeline/estimator/trials/scene.h"
#include "lodeline/estimator/uncertainty/reported_covariance.h"
#include "lodeline/problem/state/camera_states.h"

namespace lodeline {
namespace {

TEST(EvidenceForFile, IsNoneWhereNothingIsSeen) {
  EXPECT_NEAR(evidenceForFile(Eigen::VectorXd::Zero(6), Eigen::MatrixXd::Identity(6, 6), 1.0), 0.0, 1e-12);
  EXPECT_NEAR(evidenceForFile(Eigen::VectorXd::Zero(6), 0.5 * Eigen::MatrixXd::Identity(6, 6), 0.5), 0.0,
              1e-12);
}

TEST(EvidenceForFile, GrowsAsLongAsTheDeviationStaysNone) {
  double before = 0.0;
  for (const double sigma : {0.5, 0.2, 0.1, 0.01}) {
    const double evidence =
        evidenceForFile(Eigen::VectorXd::Zero(6), sigma * sigma * Eigen::MatrixXd::Identity(6, 6), 1.0);
    EXPECT_GT(evidence, before) << sigma;
    before = evidence;
  }
  // At most what the tolerance allows: six parameters, each ten times better than the prior.
  EXPECT_LT(before, 6.0 * std::log(10.1));
}

TEST(EvidenceForFile, IsTheRatioOfTwoNormalDensities) {
  const double seen = 0.4, variance = 0.04, blur = kFileTolerance * kFileTolerance;
  const auto density = [](double x, double v) { return std::exp(-0.5 * x * x / v) / std::sqrt(v); };
  EXPECT_NEAR(
      evidenceForFile(Eigen::VectorXd::Constant(1, seen), Eigen::MatrixXd::Constant(1, 1, variance), 1.0),
      std::log(density(seen, variance + blur) / density(0.0, 1.0 + blur)), 1e-12);
}

TEST(EvidenceForFile, TurnsAgainstAFileThatIsOff) {
  Eigen::VectorXd seen = Eigen::VectorXd::Zero(6);
  seen[2] = 0.7;
  EXPECT_LT(evidenceForFile(seen, 0.01 * Eigen::MatrixXd::Identity(6, 6), 1.0), 0.0);
}

/// Errors of the files, for the intrinsics of all cameras from `first_wrong` on.
struct FileErrors {
  double focal_length = 0.0;  ///< relative
  double centre_px = 0.0;
  size_t first_wrong = 0;
  double baseline_m = 0.0;
  bool is_symmetric = false;  ///< whether the estimator knows that lenses are symmetric
};

/// Last estimate of a lively scene.
FrameEstimate see(int cameras, const FileErrors& errors, bool trust = true, uint64_t seed = 1) {
  TestSceneOptions options;
  options.seed = seed;
  options.cameras = cameras;
  options.duration_s = 40.0;
  options.liveliness = 0.5;
  options.points.frame_rate_hz = 10.0;
  options.points.pixel_sigma_px = 0.2;
  TestScene scene(options);
  Rig rig = scene.rig();
  for (size_t i = errors.first_wrong; i < rig.cameras.size(); ++i) {
    CameraCalibration& camera = rig.cameras[i];
    camera.fx_px *= 1.0 + errors.focal_length;
    camera.fy_px *= 1.0 + errors.focal_length;
    camera.cx_px += errors.centre_px;
    camera.cy_px -= errors.centre_px;
  }
  const Vec3 baseline =
      rig.cameras.back().body_from_camera.translation - rig.cameras.front().body_from_camera.translation;
  if (cameras > 1)
    rig.cameras.back().body_from_camera.translation += errors.baseline_m * baseline.normalized();
  std::vector<std::shared_ptr<const Camera>> by_truth, by_file;
  for (size_t i = 0; i < rig.cameras.size(); ++i) {
    by_truth.push_back(makeCamera(scene.rig().cameras[i]));
    by_file.push_back(makeCamera(rig.cameras[i]));
  }
  EstimatorOptions estimator_options = honestOptions(options);
  estimator_options.camera_calibration = CameraCalibrationOptions();
  estimator_options.camera_calibration.trust_confirmed_files = trust;
  if (errors.is_symmetric) {
    estimator_options.camera_calibration.tangential_sigma = 0.0;
    estimator_options.camera_calibration.port_tilt_sigma = 0.0;
  }
  Diagnostics diagnostics;
  Estimator estimator(rig, estimator_options, &diagnostics);
  FrameEstimate last;
  while (auto frame = scene.next()) {
    for (FeatureObservation& observation : frame->tracks.observations) {
      const auto pixel = by_truth[observation.camera]->project(observation.bearing_C);
      observation.bearing_C = by_file[observation.camera]->unproject(*pixel)->normalized();
    }
    last = estimator.add(frame->tracks, frame->imu);
  }
  return last;
}

TEST(IntrinsicsModelSelection, HoldsFilesThatAreRight) {
  for (const auto& [cameras, seed] : {std::pair(1, 1), {1, 2}, {1, 3}, {2, 1}, {2, 2}, {2, 3}, {2, 4}}) {
    const FrameEstimate seen = see(cameras, {}, true, static_cast<uint64_t>(seed));
    ASSERT_TRUE(seen.camera_corrections.has_value());
    EXPECT_TRUE(seen.camera_corrections->are_files_held) << cameras << " cameras, seed " << seed;
    for (const auto& lens : seen.camera_corrections->intrinsics) {
      EXPECT_LT(lens.head<2>().norm(), 1e-4);
      EXPECT_LT(lens.segment<2>(2).norm(), 0.02);
    }
  }
}

TEST(IntrinsicsModelSelection, ClaimsNoMoreOfThemThanTheirTolerance) {
  const FrameEstimate held = see(2, {}), free = see(2, {}, false);
  EXPECT_TRUE(held.camera_corrections->are_files_held);
  EXPECT_FALSE(free.camera_corrections->are_files_held);
  const double held_sigma = std::sqrt(held.covariance.topLeftCorner<3, 3>().trace());
  const double free_sigma = std::sqrt(free.covariance.topLeftCorner<3, 3>().trace());
  EXPECT_LT(held_sigma, 1.05 * free_sigma);
  EXPECT_GT(held_sigma, 0.3 * free_sigma);
}

TEST(IntrinsicsModelSelection, LetsFilesBeThatAreOff) {
  for (const int cameras : {1, 2}) {
    const FrameEstimate seen = see(cameras, {.focal_length = 0.004, .centre_px = 1.5, .is_symmetric = true});
    ASSERT_TRUE(seen.camera_corrections.has_value());
    EXPECT_FALSE(seen.camera_corrections->are_files_held) << cameras;
    const auto& lens = seen.camera_corrections->intrinsics.front();
    EXPECT_NEAR(lens[2], -1.5, 0.5) << lens.transpose();
    EXPECT_NEAR(lens[3], 1.5, 0.5) << lens.transpose();
  }
}

TEST(IntrinsicsModelSelection, IsNotOutvotedByWhatIsRight) {
  const FrameEstimate seen = see(2, {.focal_length = 0.003, .first_wrong = 1});
  EXPECT_FALSE(seen.camera_corrections->are_files_held);
}

// Residuals of first order would leave the square of the noise as a bias: focal lengths 0.1 % shorter here.
TEST(Lenses, AreMadeNoShorterByNoise) {
  constexpr int kSeeds = 4;
  double mean = 0.0;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const FrameEstimate seen = see(2, {}, false, seed);
    for (const auto& lens : seen.camera_corrections->intrinsics) mean += 0.25 * lens.head<2>().sum() / kSeeds;
  }
  // One scene determines the focal length with a sigma of 0.0002.
  EXPECT_NEAR(mean, 0.0, 4e-4);
}

TEST(Placement, IsFoundWhereTheFileIsFarOff) {
  for (const double error_m : {-0.02, 0.005}) {
    const FrameEstimate seen = see(2, {.baseline_m = error_m});
    const Vec3 found = seen.camera_corrections->extrinsics.back().tail<3>();
    EXPECT_NEAR(found.norm(), std::abs(error_m), 0.002);
  }
}

/// Removed information about a secondary camera's position where its estimate is `off_m` away from its file;
/// one row and column for each of its six parameters.
Eigen::MatrixXd removedWhereFound(double off_m, Rig* rig) {
  TestSceneOptions scene;
  scene.cameras = 2;
  *rig = TestScene(scene).rig();
  const EstimatorOptions options;
  Window window;
  Prior prior;
  addCameraStates(window, prior, 2, options.camera_calibration, {});
  double* found = cameraStates(window).secondary.front()->value.data();
  found[3] = off_m;
  const auto removed = removedCalibration(window, options, FactorBuilder(*rig, options));
  if (removed.size() != 1 || removed.front().first != found) return {};
  return removed.front().second;
}

TEST(Placement, IsClaimedToAPerCentOfTheBaseline) {
  Rig rig;
  const Eigen::MatrixXd removed = removedWhereFound(0.0, &rig);
  ASSERT_EQ(removed.rows(), 6);
  const double baseline_m =
      (rig.cameras[0].body_from_camera.inverse() * rig.cameras[1].body_from_camera).translation.norm();
  const double used = 1.0 / std::pow(EstimatorOptions().camera_calibration.stereo_position_sigma_m, 2);
  const double claimed = 1.0 / std::pow(0.01 * baseline_m, 2);
  EXPECT_NEAR(removed(3, 3), used - claimed, 1e-9 * used);
  EXPECT_NEAR(removed.trace(), 3.0 * (used - claimed), 1e-9 * used);
}

TEST(Placement, FoundElsewhereHasNothingToUnclaim) {
  Rig rig;
  const Eigen::MatrixXd removed = removedWhereFound(0.02, &rig);
  ASSERT_EQ(removed.rows(), 6);
  EXPECT_EQ(removed.norm(), 0.0);
}

// The baseline is two per cent too long, and the time is too short for the accelerometer to correct it.
TEST(Placement, IsNotClaimedWhereTheFileIsOff) {
  TestSceneOptions options;
  options.duration_s = 6.0;
  options.liveliness = 0.05;
  options.drift_m_per_s = Vec3(0.3, 0.0, 0.0);
  TestScene scene(options);
  Rig rig = scene.rig();
  Vec3& secondary = rig.cameras[1].body_from_camera.translation;
  secondary += 0.02 * (secondary - rig.cameras[0].body_from_camera.translation);
  EstimatorOptions estimator_options = honestOptions(options);
  estimator_options.camera_calibration = CameraCalibrationOptions();
  // Other causes of scale uncertainty are switched off.
  estimator_options.camera_calibration.intrinsics = false;
  estimator_options.camera_calibration.stereo_rotation_sigma_rad = 0.0;
  Diagnostics diagnostics;
  Estimator estimator(rig, estimator_options, &diagnostics);
  std::optional<Vec3> from, true_from;
  double way_m = 0.0, error_m = 0.0, sigma_m = 0.0;
  while (auto frame = scene.next()) {
    const FrameEstimate estimate = estimator.add(frame->tracks, frame->imu);
    const Vec3 position = estimate.state.world_from_body.translation;
    const Vec3 true_position = frame->truth.motion.world_from_body.translation;
    const Vec3 way = position - from.value_or(position);
    way_m = (true_position - true_from.value_or(true_position)).norm();
    if (!from) {
      from = position;
      true_from = true_position;
      continue;
    }
    error_m = way.norm() - way_m;
    const Vec3 along = way.normalized();
    sigma_m = std::sqrt(along.dot(estimate.covariance.topLeftCorner<3, 3>() * along));
  }
  EXPECT_GT(error_m, 0.01 * way_m) << "the file's error was found: too easy a scene";
  EXPECT_LT(error_m, 3.0 * sigma_m);
}

TEST(Placement, StaysWhereTheFileIsRight) {
  const FrameEstimate seen = see(2, {});
  EXPECT_LT(seen.camera_corrections->extrinsics.back().tail<3>().norm(), 3e-4);
}

}  // namespace
}  // namespace lodeline

#include "lodeline/estimator/uncertainty/scale_observability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lodeline/estimator/dvl/dvl_measurement.h"
#include "lodeline/estimator/self_calibration/intrinsics_model_selection.h"
#include "lodeline/estimator/trials/test_window.h"
#include "lodeline/estimator/visual/landmarks.h"
#include "lodeline/factors/intrinsics_factor.h"
#include "lodeline/problem/state/camera_states.h"
#include "lodeline/problem/state/inertial_states.h"

namespace lodeline {
namespace {

/// Options for an IMU that its maker calibrated, or one that may not be calibrated.
EstimatorOptions optionsOf(bool is_calibrated) {
  EstimatorOptions options;
  if (is_calibrated) options.imu_axes.uncalibrated_sigma = 0.0;
  return options;
}

/// Information after all frames of a scene, at their true states.
ScaleInformation informationAfter(int cameras, double liveliness, double depth_sigma_m, double sink_m_per_s,
                                  const EstimatorOptions& options = optionsOf(true),
                                  double velocity_sigma_m_per_s = 0.0) {
  TestSceneOptions scene_options;
  scene_options.cameras = cameras;
  scene_options.liveliness = liveliness;
  scene_options.duration_s = 9.0;
  scene_options.points.tracks = 30;
  scene_options.points.frame_rate_hz = 5.0;
  scene_options.drift_m_per_s = Vec3(0.0, 0.0, -sink_m_per_s);
  TestScene scene(scene_options);
  TestWindow test(cameras);
  ScaleObservability budget(test.rig, options);
  ScaleInformation information;
  while (const auto simulated = scene.next()) {
    Frame& frame = test.add(*simulated, true);
    DepthMeasurement depth;
    depth.sigma_m = depth_sigma_m;
    if (depth_sigma_m > 0.0) frame.measurements.set(depth);
    createLandmarks(test.window, test.factors, test.options.landmark);
    information = budget.add(test.window, options.depth.density_ratio_sigma,
                             std::pow(velocity_sigma_m_per_s, 2) * Mat3::Identity());
  }
  return information;
}

TEST(ScaleObservability, OneCameraAtConstantSpeedHasNothing) {
  const ScaleInformation information = informationAfter(1, 0.0, 0.0, 0.2);
  EXPECT_EQ(information.stereo, 0.0);
  EXPECT_EQ(information.depth, 0.0);
  EXPECT_LT(information.accelerometer, 1.0);  // a scale sigma of more than 100 %
}

TEST(ScaleObservability, AccelerationCountsWithItsSquare) {
  const double calm = informationAfter(1, 0.5, 0.0, 0.0).accelerometer;
  const double lively = informationAfter(1, 1.0, 0.0, 0.0).accelerometer;
  EXPECT_NEAR(lively / calm, 4.0, 1.5);  // the noise grows with the motion, too
  EXPECT_GT(lively, 100.0);
}

TEST(ScaleObservability, AccelerationCountsAsFarAsImagesShowIt) {
  const auto by_velocity = [](double sigma_m_per_s) {
    return informationAfter(1, 1.0, 0.0, 0.0, optionsOf(true), sigma_m_per_s).accelerometer;
  };
  EXPECT_LT(by_velocity(0.1), 0.5 * by_velocity(0.0));
  EXPECT_NEAR(by_velocity(0.1) / by_velocity(0.2), 4.0, 0.1) << "the noise of the accelerometer is small";
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(by_velocity(unknown), 0.0) << "a covariance that is lost in rounding";
}

TEST(ScaleObservability, NoAccelerometerIsTrustedBeyondItsScale) {
  for (const bool is_calibrated : {true, false}) {
    const EstimatorOptions options = optionsOf(is_calibrated);
    const double sigma = is_calibrated ? 1e-3 : options.imu_axes.uncalibrated_sigma;
    const double information = informationAfter(1, 50.0, 0.0, 0.0, options).accelerometer;
    EXPECT_LT(information, 1.0 / (sigma * sigma)) << is_calibrated;
    EXPECT_GT(information, 0.5 / (sigma * sigma)) << is_calibrated;
  }
}

TEST(ScaleObservability, StereoIsAsGoodAsItsCalibration) {
  EstimatorOptions coarse, fine;
  coarse.camera_calibration.stereo_rotation_sigma_rad = 0.004;
  fine.camera_calibration.stereo_rotation_sigma_rad = 0.002;
  const double by_coarse = informationAfter(2, 1.0, 0.0, 0.0, coarse).stereo;
  const double by_fine = informationAfter(2, 1.0, 0.0, 0.0, fine).stereo;
  EXPECT_NEAR(by_fine / by_coarse, 4.0, 0.2);
  // Walls at 4 m, baseline 11 cm: 0.002 * 4 / 0.11.
  EXPECT_NEAR(1.0 / std::sqrt(by_fine), 0.07, 0.03);
}

/// Sigma of the scale by two cameras whose estimated baseline is longer than that of the file.
double stereoSigma(double found_m, bool is_file_held, const CameraCalibrationOptions& calibration) {
  EstimatorOptions options;
  options.camera_calibration = calibration;
  TestWindow test(2);
  test.fill();
  test.calibrate(TestWindow::Lens{});
  believeInFiles(test.window, calibration, is_file_held);
  cameraStates(test.window).secondary.front()->value[3] = found_m;
  return 1.0 / std::sqrt(ScaleObservability(test.rig, options).add(test.window, 1.0, Mat3::Zero()).stereo);
}

TEST(ScaleObservability, FileOfABaselineThatIsOffSaysLittle) {
  CameraCalibrationOptions calibration;
  calibration.stereo_rotation_sigma_rad = 0.0;
  const double baseline_m = (TestWindow(2).rig.cameras[1].body_from_camera.translation -
                             TestWindow(2).rig.cameras[0].body_from_camera.translation)
                                .norm();
  const double stated = std::hypot(calibration.stereo_position_sigma_m / baseline_m, 1e-3);
  EXPECT_NEAR(stereoSigma(0.0, false, calibration), stated, 1e-9);
  EXPECT_NEAR(stereoSigma(0.0, true, calibration), stated, 1e-9);
  EXPECT_NEAR(stereoSigma(0.02, false, calibration), 0.02 / baseline_m, 1e-3);
  EXPECT_NEAR(stereoSigma(0.02, true, calibration), 0.04 / baseline_m, 1e-3);
}

TEST(ScaleObservability, RotationThatImagesConfirmIsKnownTenTimesAsWell) {
  CameraCalibrationOptions calibration;
  calibration.stereo_position_sigma_m = 0.0;
  const double free = stereoSigma(0.0, false, calibration), held = stereoSigma(0.0, true, calibration);
  EXPECT_NEAR(held, std::hypot(free * kFileTolerance, 1e-3), 1e-4);
}

TEST(ScaleObservability, DepthCountsWhereTheRigSinksAndNeverBeyondTheWater) {
  const double level = informationAfter(1, 0.0, 0.05, 0.0).depth;
  const double sinking = informationAfter(1, 0.0, 0.05, 0.2).depth;
  EXPECT_LT(level, 1.0);
  // 1.6 m at constant speed in 40 readings: scatter of 0.46 m compared with 0.05 m / sqrt(40).
  EXPECT_NEAR(1.0 / std::sqrt(sinking), 0.023, 0.008);
  EXPECT_LT(informationAfter(1, 0.0, 1e-4, 0.2).depth, 1.0 / (0.015 * 0.015));
}

/// Sigma of the scale by one ping with three axes at this speed.
double dvlSigma(double speed_m_per_s, double noise_m_per_s, double scale_sigma) {
  TestWindow test(1);
  test.fill();
  test.rig.dvl.emplace().scale_sigma = scale_sigma;
  DvlPing ping;
  for (int axis = 0; axis < 3; ++axis) ping.rows.push_back({Vec3::Unit(axis), speed_m_per_s});
  ping.sigma_m_per_s = noise_m_per_s;
  DvlMeasurement measurement;
  measurement.pings = {ping};
  test.window.newest().measurements.set(measurement);
  return 1.0 /
         std::sqrt(ScaleObservability(test.rig, optionsOf(true)).add(test.window, 1.0, Mat3::Zero()).dvl);
}

TEST(ScaleObservability, DvlCountsByItsSpeedAndNeverBeyondItsCalibration) {
  // Of three axes: 0.01 / (0.5 sqrt(3)).
  EXPECT_NEAR(dvlSigma(0.5, 0.01, 0.0), 0.01155, 0.0003);
  EXPECT_NEAR(dvlSigma(0.5, 1e-5, 0.01), std::hypot(0.01, 1e-3), 1e-5);
  EXPECT_GT(dvlSigma(0.01, 0.01, 0.01), 1e3) << "noise alone";
}

}  // namespace
}  // namespace lodeline

#include "lodeline/problem/state/inertial_states.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/estimator/trials/consistency.h"
#include "lodeline/estimator/trials/scene.h"
#include "lodeline/estimator/uncertainty/covariance_inflation.h"
#include "lodeline/problem/factor_builder.h"

namespace lodeline {
namespace {

TestSceneOptions sceneOptions(uint64_t seed) {
  TestSceneOptions options;
  options.seed = seed;
  options.duration_s = 60.0;
  options.points.frame_rate_hz = 10.0;
  options.points.tracks = 30;
  return options;
}

struct Outcome {
  FrameEstimate last;
  double first_heading_variance_rad2 = 0.0;  ///< reported after 3 s
  /// Difference of the last reported heading variance from rotation errors by the intrinsics, which are
  /// larger where gyroscopes are not known to be calibrated.
  double variance_by_intrinsics_rad2 = 0.0;
  /// Change of the rotation error since the middle of the scene, root mean square.
  double drift_rad = 0.0;
};

/// Options with the given sigma of the gyroscope's axes; the accelerometer's axes are held.
ImuAxesOptions forGyroscope(double sigma, double uncalibrated_sigma = 0.0) {
  return {.gyroscope_sigma = sigma, .uncalibrated_sigma = uncalibrated_sigma, .accelerometer_sigma = 0.0};
}

ImuAxesOptions forAccelerometer(double sigma) {
  return {.gyroscope_sigma = 0.0, .uncalibrated_sigma = 0.0, .accelerometer_sigma = sigma};
}

/// Sensor reading of a true value. True values are (I + D) times the reading, D column by column.
Vec3 readingOf(const Vec3& value, const SensorAxes& axes) {
  return (Mat3::Identity() + axes.reshaped(3, 3)).inverse() * value;
}

/// Runs a scene with an IMU that has axes errors.
Outcome runWith(const ImuAxes& axes, const ImuAxesOptions& axes_options, uint64_t seed = 1) {
  const TestSceneOptions scene_options = sceneOptions(seed);
  TestScene scene(scene_options);
  EstimatorOptions options = honestOptions(scene_options);
  options.imu_axes = axes_options;
  ComparedEstimator estimator(scene, options);
  CovarianceInflation lenses(options);
  Outcome outcome;
  std::optional<Vec3> error_before;
  double squares = 0.0;
  int frames = 0;
  while (auto frame = scene.next()) {
    for (ImuSample& reading : frame->imu) {
      reading.angular_velocity_B = readingOf(reading.angular_velocity_B, axes.gyroscope);
      reading.specific_force_B = readingOf(reading.specific_force_B, axes.accelerometer);
    }
    const Comparison compared = estimator.add(*frame);
    outcome.last = compared.estimate;
    if (compared.initialized())
      lenses.follow(outcome.last.state.world_from_body, outcome.last.scene_distance_m);
    if (compared.time_s < 3.0) outcome.first_heading_variance_rad2 = compared.estimate.covariance(5, 5);
    if (compared.time_s < 0.5 * scene_options.duration_s) continue;
    const Vec3 error = compared.error.tail<3>();
    error_before = error_before.value_or(error);
    squares += (error - *error_before).squaredNorm();
    ++frames;
  }
  outcome.drift_rad = std::sqrt(squares / frames);
  for (const bool is_known : {false, true}) {
    Eigen::Matrix<double, 15, 15> added = Eigen::Matrix<double, 15, 15>::Zero();
    lenses.addTo({.is_scale_given = true, .are_gyroscope_axes_known = is_known}, &added);
    outcome.variance_by_intrinsics_rad2 += is_known ? -added(5, 5) : added(5, 5);
  }
  return outcome;
}

/// Root mean square over seeds, because one scene is one draw of a random walk.
double drift_rad(const ImuAxes& axes, const ImuAxesOptions& options, uint64_t seeds) {
  double squares = 0.0;
  for (uint64_t seed = 1; seed <= seeds; ++seed)
    squares += std::pow(runWith(axes, options, seed).drift_rad, 2);
  return std::sqrt(squares / static_cast<double>(seeds));
}

TEST(InertialStates, FindTheAxesOfAGyroscopeThatWasNeverCalibrated) {
  SensorAxes axes;
  axes << 0.012, -0.006, 0.009, 0.004, -0.015, -0.007, 0.003, 0.011, 0.02;
  const Outcome held = runWith({.gyroscope = axes}, forGyroscope(0.0));
  const Outcome found = runWith({.gyroscope = axes}, forGyroscope(0.001));
  EXPECT_FALSE(held.last.gyroscope_axes);
  ASSERT_TRUE(found.last.gyroscope_axes);
  EXPECT_LT((*found.last.gyroscope_axes - axes).norm(), 0.25 * axes.norm())
      << found.last.gyroscope_axes->transpose();
  EXPECT_LT(drift_rad({.gyroscope = axes}, forGyroscope(0.001), 4),
            0.5 * drift_rad({.gyroscope = axes}, forGyroscope(0.0), 4));
}

TEST(InertialStates, FindTheAxesOfAnAccelerometerThatWasNeverCalibrated) {
  SensorAxes axes;
  axes << 0.012, -0.006, 0.009, 0.004, -0.015, -0.007, 0.003, 0.011, 0.02;
  const Outcome held = runWith({.accelerometer = axes}, forAccelerometer(0.0));
  const Outcome found = runWith({.accelerometer = axes}, forAccelerometer(0.001));
  EXPECT_FALSE(held.last.accelerometer_axes);
  ASSERT_TRUE(found.last.accelerometer_axes);
  EXPECT_LT((*found.last.accelerometer_axes - axes).norm(), 0.25 * axes.norm())
      << found.last.accelerometer_axes->transpose();
}

TEST(InertialStates, AreDoubtedOfALoudGyroscopeThatIsNotHeld) {
  Rig rig;
  EstimatorOptions options;
  ImuAxesOptions& axes = options.imu_axes;
  rig.imu.noise.gyroscope_density_rad_per_s_sqrtHz = 0.9 * imu_axes::kCalibratedBelow_rad_per_s_sqrtHz;
  EXPECT_FALSE(optionsFor(rig, options).imu_axes.areDoubted());
  rig.imu.noise.gyroscope_density_rad_per_s_sqrtHz = 1.1 * imu_axes::kCalibratedBelow_rad_per_s_sqrtHz;
  EXPECT_TRUE(optionsFor(rig, options).imu_axes.areDoubted());
  axes.gyroscope_sigma = 0.0;
  EXPECT_FALSE(optionsFor(rig, options).imu_axes.areDoubted());
}

TEST(InertialStates, AreDoubtedAsTheCalibrationStates) {
  Rig rig;
  rig.imu.noise.gyroscope_density_rad_per_s_sqrtHz = 2.0 * imu_axes::kCalibratedBelow_rad_per_s_sqrtHz;
  rig.imu.noise.axes_sigma = 0.001;
  EXPECT_FALSE(optionsFor(rig, {}).imu_axes.areDoubted());
  rig.imu.noise.gyroscope_density_rad_per_s_sqrtHz = 0.5 * imu_axes::kCalibratedBelow_rad_per_s_sqrtHz;
  rig.imu.noise.axes_sigma = 0.02;
  EXPECT_EQ(optionsFor(rig, {}).imu_axes.uncalibrated_sigma, 0.02);
  EXPECT_EQ(optionsFor(rig, {}).imu_axes.gyroscope_sigma, 0.02);
}

// An estimated error must not be part of the noise as well.
TEST(InertialStates, LeaveLittleToTheMotionNoiseOfACalibratedImu) {
  Rig rig;
  EstimatorOptions options;
  const double doubted = options.preintegration.motion_noise.axis_error;
  const double beside = options.imu_axes.error_beside_states;
  const auto axisError = [&] { return optionsFor(rig, options).preintegration.motion_noise.axis_error; };
  ASSERT_LT(beside, doubted);
  rig.imu.noise.gyroscope_density_rad_per_s_sqrtHz = 0.9 * imu_axes::kCalibratedBelow_rad_per_s_sqrtHz;
  EXPECT_EQ(axisError(), beside);
  options.imu_axes.accelerometer_sigma = 0.0;
  EXPECT_EQ(axisError(), doubted) << "these axes are no states";
  options.imu_axes.accelerometer_sigma = options.imu_axes.gyroscope_sigma;
  options.preintegration.motion_noise.axis_error = 0.5 * beside;
  EXPECT_EQ(axisError(), 0.5 * beside) << "less was asked for";
  options.preintegration.motion_noise.axis_error = doubted;
  rig.imu.noise.gyroscope_density_rad_per_s_sqrtHz = 1.1 * imu_axes::kCalibratedBelow_rad_per_s_sqrtHz;
  EXPECT_EQ(axisError(), doubted) << "perhaps never calibrated";
}

TEST(InertialStates, AreNoneWhereTheAxesAreHeld) {
  Window held, estimated;
  addInertialStates(held, {.gyroscope_sigma = 0.0, .accelerometer_sigma = 0.0});
  EXPECT_TRUE(held.globals().empty());
  addInertialStates(estimated, {});
  ASSERT_TRUE(gyroscopeAxes(estimated));
  EXPECT_TRUE(gyroscopeAxes(estimated)->isZero());
  ASSERT_TRUE(accelerometerAxes(estimated));
  EXPECT_TRUE(accelerometerAxes(estimated)->isZero());
}

/// Cost of the prior where one axis has the error `error`.
double costOfAxes(double error) {
  Window window;
  addInertialStates(window, {});
  ImuAxesStates(window).gyroscope->value[0] = error;
  std::vector<double> residual;
  double cost = 0.0;
  for (const Factor& prior : FactorBuilder(Rig(), EstimatorOptions()).imuAxes(window))
    cost += costOf(prior, residual);
  return cost;
}

TEST(InertialStates, MayBeOffByPerCentsAndNotByTens) {
  EXPECT_LT(costOfAxes(0.03) - costOfAxes(0.01), 15.0) << "a sensor that nobody calibrated";
  EXPECT_GT(costOfAxes(0.3) - costOfAxes(0.03), 45.0) << "one that nobody sells";
}

// Vision detects an error of three of its sigmas, whatever the sensor's noise.
TEST(InertialStates, FindASmallErrorOfACalibratedGyroscope) {
  SensorAxes axes;
  axes << 0.003, -0.002, 0.001, 0.002, -0.0027, 0.0024, 0.0019, -0.0024, 0.0024;
  EXPECT_LT(drift_rad({.gyroscope = axes}, forGyroscope(0.001), 4),
            0.8 * drift_rad({.gyroscope = axes}, forGyroscope(0.0), 4));
}

TEST(InertialStates, ClaimNoMoreOfUpThanTheAccelerometersAxesAllow) {
  constexpr double kSigma = 0.002;
  const Outcome held = runWith({}, forGyroscope(0.0));
  const Outcome in_doubt = runWith({}, forGyroscope(kSigma));
  for (const int axis : {3, 4}) {
    EXPECT_GT(in_doubt.last.covariance(axis, axis), std::pow(kSigma, 2)) << axis;
    EXPECT_LT(held.last.covariance(axis, axis), std::pow(kSigma, 2)) << axis;
  }
}

TEST(InertialStates, ClaimLessOfWhatWasPerhapsNeverCalibrated) {
  constexpr double kUncalibrated = 0.007;
  const Outcome taken_for_calibrated = runWith({}, forGyroscope(0.001));
  const Outcome in_doubt = runWith({}, forGyroscope(0.001, kUncalibrated));
  const FrameEstimate& believed = taken_for_calibrated.last;
  const FrameEstimate& doubted = in_doubt.last;
  for (int axis = 0; axis < 15; ++axis)
    EXPECT_GE(doubted.covariance(axis, axis), believed.covariance(axis, axis)) << axis;
  EXPECT_GT(doubted.covariance(3, 3), std::pow(kUncalibrated, 2));
  EXPECT_GT(doubted.covariance(4, 4), std::pow(kUncalibrated, 2));
  EXPECT_GT(in_doubt.first_heading_variance_rad2, 1.02 * taken_for_calibrated.first_heading_variance_rad2);
  EXPECT_LT(doubted.covariance(5, 5) - in_doubt.variance_by_intrinsics_rad2, 1.02 * believed.covariance(5, 5))
      << "turns have shown the axes by now";
  EXPECT_EQ(doubted.sensors.of<MagnetometerEstimate>().heading_sigma_rad,
            std::sqrt(doubted.covariance(5, 5)));
}

/// Means over scenes with accelerometer biases four times as large as the initial sigma, soon after the
/// start.
ConsistencyRow biasedStarts(double uncalibrated_sigma) {
  constexpr double kBias_m_per_s2 = 0.4;
  ConsistencyOptions options;
  options.scene = sceneOptions(1);
  options.scene.accelerometer_bias_sigma_m_per_s2 = kBias_m_per_s2;
  options.estimator = honestOptions(options.scene);
  options.estimator.initial_state.accelerometer_bias_sigma_m_per_s2 = 0.25 * kBias_m_per_s2;
  options.estimator.imu_axes = {.gyroscope_sigma = 0.001,
                                .uncalibrated_sigma = uncalibrated_sigma,
                                .uncalibrated_bias_sigma_m_per_s2 = kBias_m_per_s2,
                                .accelerometer_sigma = 0.0};
  options.times_s = {1.5};
  return measureConsistency(options).rows.front();
}

TEST(InertialStates, ClaimLessOfUpAtTheStartOfWhatWasPerhapsNeverCalibrated) {
  constexpr double kHardlyAnyAxes = 1e-6;
  const ConsistencyRow taken_for_calibrated = biasedStarts(0.0), in_doubt = biasedStarts(kHardlyAnyAxes);
  for (const auto figure : {&NeesSample::orientation, &NeesSample::accelerometer_bias}) {
    EXPECT_GT(taken_for_calibrated.mean(figure), 5.0 * 3.0);
    EXPECT_LT(in_doubt.mean(figure), 2.0 * 3.0);
    EXPECT_GT(in_doubt.mean(figure), 0.5 * 3.0);
  }
}

TEST(InertialStates, StayNearRightAxes) {
  const Outcome found = runWith({}, forGyroscope(0.001));
  ASSERT_TRUE(found.last.gyroscope_axes);
  EXPECT_LT(found.last.gyroscope_axes->cwiseAbs().maxCoeff(), 2e-3) << found.last.gyroscope_axes->transpose();
  EXPECT_LT(drift_rad({}, forGyroscope(0.001), 24), 1.1 * drift_rad({}, forGyroscope(0.0), 24));
}

}  // namespace
}  // namespace lodeline

#include "lodeline/estimator/magnetometer/magnetometer_fusion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lodeline/estimator/initialization/start.h"
#include "lodeline/estimator/solver/window_solver.h"
#include "lodeline/estimator/trials/heading_trial.h"
#include "lodeline/estimator/trials/test_window.h"
#include "lodeline/estimator/visual/landmarks.h"
#include "lodeline/factors/sensors/magnetometer_field_factor.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/util/angles.h"
#include "simulation/shared/random.h"

namespace lodeline {
namespace {

const Vec3 kField_W(4e-6, 24e-6, -38e-6);

TestSceneOptions sceneOptions(double duration_s, double frame_rate_hz) {
  TestSceneOptions options;
  options.duration_s = duration_s;
  options.points.tracks = 40;
  options.points.frame_rate_hz = frame_rate_hz;
  return options;
}

FieldMeasurement measurementOf(const SimulatedFrame& frame) {
  FieldMeasurement measurement;
  measurement.mean.time = frame.truth.time;
  measurement.mean.field_B = frame.truth.motion.world_from_body.rotation.conjugate() * kField_W;
  measurement.mean.newest_B = measurement.mean.field_B;
  measurement.mean.readings = 3;
  measurement.noise = {0.1e-6, 1e-4, 2e-3};
  return measurement;
}

// Runs a window with a magnetometer and without any prior. Returns the information of its marginalization
// prior on a rotation of everything about gravity, 1/rad^2.
double yawInformationAfter(int frames, bool relative, bool keep_linearization_points) {
  TestWindow test(2);
  Marginalizer marginalizer(test.factors);
  TestScene scene(sceneOptions(1.0 + 0.1 * frames, 10.0));
  test.window.add({MagnetometerStates::kField, {5e-6, 23e-6, -37e-6}, std::nullopt, 0.0});
  test.window.add({MagnetometerStates::kOffset, {0.0, 0.0, 0.0}, std::nullopt, 0.0});
  test.window.add({MagnetometerStates::kDisturbance, {0.0, 0.0, 0.0}, std::nullopt, 0.0});
  marginalizer.addKnowledge(*test.window.findGlobal(MagnetometerStates::kOffset), Vec3::Constant(1e-6));
  for (int k = 0; k < frames; ++k) {
    const SimulatedFrame simulated = *scene.next();
    Frame& frame = test.add(simulated, k % 2 == 0);
    FieldMeasurement measured = measurementOf(simulated);
    measured.relative = relative;
    frame.measurements.set(measured);
    createLandmarks(test.window, test.factors, test.options.landmark);
    if (k < 3) continue;
    EXPECT_TRUE(solveWithCeres(test.window, marginalizer.prior(), test.factors, {4, 1e-6}).usable);
    removeOutliers(test.window, test.factors, test.options.landmark);
    marginalizer.marginalizeToSize(test.window, {.recent_frames = 3, .keyframes = 3});
    if (keep_linearization_points) continue;
    for (const auto& state : test.window.globals()) state->first.reset();
    for (const auto& other : test.window.frames()) {
      other->first_pose.reset();
      other->first_motion.reset();
    }
  }
  const Prior& prior = marginalizer.prior();
  Eigen::VectorXd yaw = Eigen::VectorXd::Zero(prior.tangentSize());
  int row = 0;
  bool has_field = false;
  for (const Prior::Block& block : prior.blocks) {
    const bool is_field = block.value == MagnetometerStates(test.window).field->value.data();
    const bool is_offset = block.value == MagnetometerStates(test.window).offset->value.data();
    has_field = has_field || is_field;
    // Position, velocity or field.
    if (!is_offset) yaw.segment<3>(row) = Vec3::UnitZ().cross(Vec3(block.linearization_point.head<3>()));
    if (block.isPose()) yaw[row + 5] = 1.0;
    row += block.tangentSize();
  }
  EXPECT_EQ(has_field, !relative);
  return (prior.sqrt_information * yaw).squaredNorm();
}

TEST(MagnetometerInTheWindow, LeavesTheYawOfTheWorldUnobservable) {
  // As without a magnetometer (marginalizer_test.cpp): less than 0.1 rad once.
  EXPECT_LT(yawInformationAfter(30, false, true), 1e2);
  EXPECT_LT(yawInformationAfter(30, true, true), 1e2);
  EXPECT_GT(yawInformationAfter(30, false, false), 1e4) << "linearization points are not needed here?";
}

HeadingTrialOptions trialOptions(double duration_s) {
  HeadingTrialOptions options;
  options.duration_s = duration_s;
  options.frame_rate_hz = 4.0;
  options.tracks = 30;
  options.estimator.magnetometer.use = MagnetometerUse::Absolute;
  return options;
}

HeadingTrial withoutMagnetometer(HeadingTrialOptions options) {
  options.estimator.magnetometer.use = MagnetometerUse::Off;
  return runHeadingTrial(options);
}

TEST(MagnetometerFusion, FindsNorthAndKeepsIt) {
  for (const int cameras : {2, 1}) {
    HeadingTrialOptions options = trialOptions(40.0);
    options.cameras = cameras;
    if (cameras == 1) options.frame_rate_hz = 10.0;
    if (cameras == 1) options.tracks = 80;
    const HeadingTrial trial = runHeadingTrial(options);
    ASSERT_GT(trial.samples.size(), 120u);
    EXPECT_EQ(trial.reference, HeadingReference::Magnetic);
    EXPECT_GT(trial.share(MagnetometerStatus::Used), 0.95);
    EXPECT_LT(trial.largest(5.0), 0.8 * kDegree) << cameras;
    EXPECT_GT(trial.samples.front().sigma_rad, 4.0 * kDegree);
    EXPECT_LT(trial.claimed(20.0), 1.2 * kDegree);
    EXPECT_GT(trial.claimed(20.0), 0.1 * kDegree);
  }
}

TEST(MagnetometerFusion, StaysOutOfAHeadingThatItCannotImprove) {
  HeadingTrialOptions options = trialOptions(110.0);
  const HeadingTrial off = withoutMagnetometer(options);
  options.trouble = FieldTrouble::Tank;
  const HeadingTrial tank = runHeadingTrial(options);
  EXPECT_LT(tank.alignedRms(10.0), 1.1 * off.alignedRms(10.0) + 0.05 * kDegree);
  EXPECT_LT(tank.share(MagnetometerStatus::Used), 0.95) << "nothing was rejected";
  // Six of 3 to 10 degrees in less than two minutes, before the offset is known.
  options.trouble = FieldTrouble::Disturbances;
  const HeadingTrial disturbed = runHeadingTrial(options);
  EXPECT_LT(disturbed.largest(10.0), 0.8 * kDegree);
  EXPECT_LT(disturbed.share(MagnetometerStatus::Used), 0.8) << "nothing was rejected";
  // A wrong calibration is distinguished from disturbances, here with a shorter margin than in a dive.
  options.trouble = FieldTrouble::Misalignment;
  options.estimator.magnetometer.gate.rejection_margin_s = 30.0;
  const HeadingTrial misaligned = runHeadingTrial(options);
  EXPECT_LT(misaligned.alignedRms(20.0), 1.1 * off.alignedRms(20.0) + 0.02 * kDegree);
  EXPECT_GT(misaligned.share(MagnetometerStatus::Inconsistent), 0.2);
}

TEST(MagnetometerFusion, LearnsAnOffsetThatCalibrationLeft) {
  HeadingTrialOptions options = trialOptions(100.0);
  options.trouble = FieldTrouble::HardIron;
  const HeadingTrial trial = runHeadingTrial(options);
  EXPECT_LT(trial.rms(70.0), 0.3 * kDegree);
}

TEST(MagnetometerFusion, IsNotTurnedByALampThatIsSwitched) {
  HeadingTrialOptions options = trialOptions(240.0);
  options.seed = 2;  // the lamp is first switched after half a minute
  const HeadingTrial quiet = runHeadingTrial(options);
  options.trouble = FieldTrouble::Lamp;
  const HeadingTrial corrected = runHeadingTrial(options);
  EXPECT_LT(corrected.alignedRms(40.0), quiet.alignedRms(40.0) + 0.02 * kDegree);
  EXPECT_GT(corrected.share(MagnetometerStatus::Used), 0.95);
  options.estimator.magnetometer.step.enabled = false;
  const HeadingTrial believed = runHeadingTrial(options);
  EXPECT_GT(believed.alignedRms(40.0), 2.0 * corrected.alignedRms(40.0)) << "this lamp disturbs nobody";
}

TEST(MagnetometerFusion, OffChangesNotABit) {
  TestSceneOptions scene_options = sceneOptions(4.0, 10.0);
  std::vector<FrameEstimate> last;
  for (const bool on_board : {false, true}) {
    TestScene scene(scene_options);
    Rig rig = scene.rig();
    EstimatorOptions options;
    if (on_board) {
      rig.magnetometer = MagnetometerCalibration();
      rig.magnetometer->is_calibrated = true;
      options.magnetometer.use = MagnetometerUse::Off;
    }
    Diagnostics diagnostics;
    Estimator estimator(rig, options, &diagnostics);
    FrameEstimate estimate;
    while (const auto frame = scene.next()) {
      const Quat& rotation = frame->truth.motion.world_from_body.rotation;
      const MagnetometerSample reading{frame->truth.time, rotation.conjugate() * kField_W};
      estimate = estimator.add(frame->tracks, frame->imu,
                               on_board ? SensorReadings(std::vector{reading}) : SensorReadings());
    }
    last.push_back(estimate);
    EXPECT_EQ(estimate.sensors.of<MagnetometerEstimate>().status, MagnetometerStatus::Off);
    EXPECT_EQ(estimate.sensors.of<MagnetometerEstimate>().heading_reference, HeadingReference::Start);
    EXPECT_TRUE(diagnostics.ranked().empty());
  }
  EXPECT_EQ(last[0].covariance, last[1].covariance);
  EXPECT_EQ(last[0].state.world_from_body.translation, last[1].state.world_from_body.translation);
  EXPECT_EQ(last[0].state.world_from_body.rotation.coeffs(), last[1].state.world_from_body.rotation.coeffs());
}

// An estimator whose magnetometer readings pass through `spoil`.
class SpoiltMagnetometer : public testing::Test {
 protected:
  template <typename Spoil>
  FrameEstimate run(const Spoil& spoil, MagnetometerUse use = MagnetometerUse::Automatic,
                    double rate_hz = 50.0) {
    TestSceneOptions scene_options = sceneOptions(5.0, 10.0);
    TestScene scene(scene_options);
    Rig rig = scene.rig();
    rig.magnetometer = calibration_;
    rig.magnetometer->rate_hz = rate_hz;
    EstimatorOptions options;
    options.magnetometer.use = use;
    rig.imu.noise.axes_sigma = axes_sigma_;
    Estimator estimator(rig, options, &diagnostics_);
    FrameEstimate estimate;
    int64_t reading = 0;
    while (const auto frame = scene.next()) {
      // The rig turns at a nearly constant rate between frames; earlier readings are left out.
      std::vector<MagnetometerSample> readings;
      const Quat& rotation = frame->truth.motion.world_from_body.rotation;
      for (;; ++reading) {
        const Time time =
            scene_options.points.start + Duration::fromSeconds(static_cast<double>(reading) / rate_hz);
        if (time > frame->truth.time) break;
        const double before_s = (frame->truth.time - time).seconds();
        if (before_s > 0.15) continue;
        const Quat turned = rotation * so3::exp(-before_s * frame->truth.motion.angular_velocity_B);
        MagnetometerSample sample{time, turned.conjugate() * kField_W};
        sample.field_M.x() += 1e-12 * static_cast<double>(reading % 7);  // so that no two readings are equal
        spoil(reading, &sample);
        readings.push_back(sample);
      }
      estimate = estimator.add(frame->tracks, frame->imu, SensorReadings(readings));
      ++statuses_[estimate.sensors.of<MagnetometerEstimate>().status];
    }
    EXPECT_EQ(estimate.status, Status::Tracking);
    EXPECT_TRUE(estimate.covariance.allFinite());
    return estimate;
  }
  static void leave(int64_t, MagnetometerSample*) {}

  SpoiltMagnetometer() { calibration_.is_calibrated = true; }

  MagnetometerCalibration calibration_;
  double axes_sigma_ = 0.001;
  Diagnostics diagnostics_;
  std::map<MagnetometerStatus, int> statuses_;
};

TEST_F(SpoiltMagnetometer, WithNothingWrongIsUsed) {
  const FrameEstimate estimate = run(leave);
  const auto& magnetometer = estimate.sensors.of<MagnetometerEstimate>();
  EXPECT_EQ(magnetometer.heading_reference, HeadingReference::Magnetic);
  EXPECT_EQ(magnetometer.status, MagnetometerStatus::Used);
  EXPECT_EQ(diagnostics_.count("heading_not_aligned"), 0);
  EXPECT_LT(std::abs(magnetometer.north_from_world_rad.value()), 6.0 * kDegree) << "by the first tilt";
  ASSERT_TRUE(magnetometer.north_found);
  EXPECT_LE(*magnetometer.north_found, estimate.time) << "known from the first pose on";
}

TEST_F(SpoiltMagnetometer, OfNaNsIsNoData) {
  const FrameEstimate estimate =
      run([](int64_t, MagnetometerSample* s) { s->field_M.y() = std::numeric_limits<double>::quiet_NaN(); });
  const auto& magnetometer = estimate.sensors.of<MagnetometerEstimate>();
  EXPECT_EQ(magnetometer.status, MagnetometerStatus::NoData);
  EXPECT_EQ(magnetometer.heading_reference, HeadingReference::Start);
  EXPECT_GT(diagnostics_.count("magnetometer_invalid"), 100);
  EXPECT_EQ(diagnostics_.count("heading_not_aligned"), 1);
}

TEST_F(SpoiltMagnetometer, ThatFreezesIsNoData) {
  const FrameEstimate estimate = run([](int64_t i, MagnetometerSample* s) {
    if (i > 100) s->field_M = Vec3(1e-6, 20e-6, 30e-6);
  });
  EXPECT_EQ(estimate.sensors.of<MagnetometerEstimate>().status, MagnetometerStatus::NoData);
  EXPECT_EQ(diagnostics_.count("magnetometer_frozen"), 1);
}

TEST_F(SpoiltMagnetometer, ThatIsNotWantedStillTellsItsFaults) {
  const FrameEstimate estimate = run(
      [](int64_t i, MagnetometerSample* s) {
        if (i > 100) s->field_M = Vec3(1e-6, 20e-6, 30e-6);
      },
      MagnetometerUse::Off);
  EXPECT_EQ(estimate.sensors.of<MagnetometerEstimate>().status, MagnetometerStatus::Off);
  EXPECT_EQ(diagnostics_.count("magnetometer_frozen"), 1);
}

TEST_F(SpoiltMagnetometer, InMicroteslaIsConvertedWithAWarning) {
  const FrameEstimate estimate = run([](int64_t, MagnetometerSample* s) { s->field_M *= 1e6; });
  const auto& magnetometer = estimate.sensors.of<MagnetometerEstimate>();
  EXPECT_EQ(magnetometer.status, MagnetometerStatus::Used);
  EXPECT_EQ(diagnostics_.count("magnetometer_converted"), 1);
  EXPECT_NEAR(magnetometer.field_W->norm(), kField_W.norm(), 1e-6);
}

TEST_F(SpoiltMagnetometer, ComesAtAnyRate) {
  for (const double rate_hz : {1.0, 1000.0}) {
    statuses_.clear();
    const FrameEstimate estimate = run(leave, MagnetometerUse::Automatic, rate_hz);
    EXPECT_EQ(estimate.sensors.of<MagnetometerEstimate>().heading_reference, HeadingReference::Magnetic)
        << rate_hz;
    EXPECT_GT(statuses_[MagnetometerStatus::Used], 3) << rate_hz;
    EXPECT_EQ(statuses_[MagnetometerStatus::NoData] > 0, rate_hz < 10.0);
  }
}

TEST_F(SpoiltMagnetometer, ThatComesLateIsUsedFromThenOn) {
  const FrameEstimate estimate = run([](int64_t i, MagnetometerSample* s) {
    if (i < 150) s->field_M.setConstant(std::numeric_limits<double>::quiet_NaN());
  });
  const auto& magnetometer = estimate.sensors.of<MagnetometerEstimate>();
  EXPECT_EQ(magnetometer.heading_reference, HeadingReference::Magnetic);
  EXPECT_EQ(magnetometer.status, MagnetometerStatus::Used);
  ASSERT_TRUE(magnetometer.field_W.has_value());
  // In the estimator's own world, which stays that of the first pose.
  const double azimuth_rad = std::atan2(magnetometer.field_W->y(), magnetometer.field_W->x());
  EXPECT_NEAR(
      std::remainder(azimuth_rad + *magnetometer.north_from_world_rad - 90.0 * kDegree, 360.0 * kDegree), 0.0,
      1e-9);
  EXPECT_EQ(diagnostics_.count("heading_not_aligned"), 1);
  EXPECT_EQ(diagnostics_.count("north_found"), 1);
}

// The lag in a calibration removes the readings before the first image.
TEST_F(SpoiltMagnetometer, ThatMissesTheFirstFrameAloneIsAsGoodAsInTime) {
  const FrameEstimate estimate = run([](int64_t i, MagnetometerSample* s) {
    if (i < 2) s->field_M.setConstant(std::numeric_limits<double>::quiet_NaN());
  });
  const auto& magnetometer = estimate.sensors.of<MagnetometerEstimate>();
  EXPECT_EQ(magnetometer.heading_reference, HeadingReference::Magnetic);
  EXPECT_TRUE(magnetometer.north_from_world_rad.has_value());
  EXPECT_EQ(diagnostics_.count("heading_not_aligned"), 0);
}

TEST_F(SpoiltMagnetometer, WhoseFieldPointsUpIsDoubted) {
  run([](int64_t, MagnetometerSample* s) { s->field_M *= -1.0; });
  EXPECT_EQ(diagnostics_.count("magnetic_field_upwards"), 1);
}

TEST_F(SpoiltMagnetometer, AsInThePaperFindsNorthLate) {
  const FrameEstimate estimate = run(
      [](int64_t i, MagnetometerSample* s) {
        if (i < 100) s->field_M.setConstant(std::numeric_limits<double>::quiet_NaN());
      },
      MagnetometerUse::Paper);
  const auto& magnetometer = estimate.sensors.of<MagnetometerEstimate>();
  EXPECT_EQ(magnetometer.heading_reference, HeadingReference::Magnetic);
  EXPECT_TRUE(magnetometer.north_from_world_rad.has_value());
}

TEST_F(SpoiltMagnetometer, ThatLosesTheFieldIsRejectedAndSaysSo) {
  run([](int64_t i, MagnetometerSample* s) {
    if (i > 150) s->field_M *= 1.2;
  });
  EXPECT_GT(statuses_[MagnetometerStatus::Norm], 10);
  EXPECT_EQ(diagnostics_.count("magnetometer_rejected"), 1);
}

TEST_F(SpoiltMagnetometer, WithoutCalibrationIsUsedOnlyWhenAskedTo) {
  calibration_.is_calibrated = false;
  EXPECT_EQ(run(leave).sensors.of<MagnetometerEstimate>().status, MagnetometerStatus::Uncalibrated);
  EXPECT_EQ(diagnostics_.count("magnetometer_uncalibrated"), 1);
  const FrameEstimate asked = run(leave, MagnetometerUse::Absolute);
  const auto& magnetometer = asked.sensors.of<MagnetometerEstimate>();
  EXPECT_EQ(magnetometer.status, MagnetometerStatus::Used);
  EXPECT_GT(magnetometer.heading_sigma_rad, 1.0 * kDegree) << "hard iron may be anything";
  const Vec3 field_W = magnetometer.field_W.value();
  EXPECT_NEAR(magnetometer.axes_sigma_rad, 0.03 * field_W.norm() / field_W.head<2>().norm(), 1e-12);
  EXPECT_GT(asked.covariance(5, 5), std::pow(magnetometer.axes_sigma_rad, 2)) << "and so may its axes";
  EXPECT_EQ(diagnostics_.count("magnetometer_uncalibrated"), 2);
}

// Such a magnetometer is calibrated against the gyroscope, whose axes differ from those of the housing.
TEST_F(SpoiltMagnetometer, OnAnImuThatWasPerhapsNeverCalibratedClaimsLess) {
  const FrameEstimate believed = run(leave);
  EXPECT_EQ(believed.sensors.of<MagnetometerEstimate>().axes_sigma_rad, 0.0);
  axes_sigma_ = 0.007;
  const FrameEstimate doubted = run(leave);
  const auto& magnetometer = doubted.sensors.of<MagnetometerEstimate>();
  const Vec3 field_W = magnetometer.field_W.value();
  EXPECT_NEAR(magnetometer.axes_sigma_rad, 0.007 * field_W.norm() / field_W.head<2>().norm(), 1e-12);
  EXPECT_GT(doubted.covariance(5, 5),
            believed.covariance(5, 5) + std::pow(0.9 * magnetometer.axes_sigma_rad, 2));
}

TEST_F(SpoiltMagnetometer, AsInThePaperTellsNoField) {
  const FrameEstimate estimate = run(leave, MagnetometerUse::Paper);
  const auto& magnetometer = estimate.sensors.of<MagnetometerEstimate>();
  EXPECT_EQ(magnetometer.status, MagnetometerStatus::Used);
  EXPECT_EQ(magnetometer.heading_reference, HeadingReference::Magnetic);
  EXPECT_FALSE(magnetometer.field_W.has_value());
}

}  // namespace
}  // namespace lodeline

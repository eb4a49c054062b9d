#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/estimator/trials/heading_trial.h"
#include "lodeline/util/angles.h"

// Electric currents beside a magnetometer, in dives with simulated points: eight thrusters with up to 20 A
// and 9 uT each, and a lamp.

namespace lodeline {
namespace {

constexpr double kSettled_s = 20.0;

HeadingTrialOptions trialOptions(double duration_s) {
  HeadingTrialOptions options;
  options.duration_s = duration_s;
  options.frame_rate_hz = 4.0;
  options.tracks = 30;
  options.estimator.magnetometer.use = MagnetometerUse::Absolute;
  options.currents.emplace();
  return options;
}

TEST(MagnetometerWithCurrents, AreRejectedWithoutTheirMeasurement) {
  HeadingTrialOptions options = trialOptions(60.0);
  options.currents->has_sensor = false;
  const TrialCurrents currents(*options.currents, options.duration_s, options.seed);
  double square = 0.0;
  for (int i = 0; i < 600; ++i) square += currents.field_M(0.1 * i).squaredNorm() / 600.0;
  constexpr double kHorizontal_T = 24.2e-6;
  EXPECT_GT(std::sqrt(square / 3.0) / kHorizontal_T, 5.0 * kDegree) << "of a compass: nobody is disturbed";
  const HeadingTrial blind = runHeadingTrial(options);
  EXPECT_LT(blind.share(MagnetometerStatus::Used), 0.3);
  EXPECT_TRUE(blind.current_status.empty());
}

TEST(MagnetometerWithCurrents, KeepsTheHeadingByACalibration) {
  const HeadingTrial trial = runHeadingTrial(trialOptions(90.0));
  EXPECT_LT(trial.rms(kSettled_s), 0.5 * kDegree);
  EXPECT_GT(trial.share(MagnetometerStatus::Used), 0.95);
  EXPECT_EQ(trial.findings.count("current_compensation_wrong"), 0);
  EXPECT_GT(trial.current_status.at("compensated"), 300);
  EXPECT_GT(trial.claimed(kSettled_s), 0.3 * trial.rms(kSettled_s));
}

TEST(MagnetometerWithCurrents, LearnsTheFieldsInTheDive) {
  HeadingTrialOptions options = trialOptions(90.0);
  options.currents->is_calibrated = false;
  const HeadingTrial trial = runHeadingTrial(options);
  EXPECT_LT(trial.rms(kSettled_s), 0.5 * kDegree);
  EXPECT_GT(trial.current_status.at("learned"), 300);
}

TEST(MagnetometerWithCurrents, NoticesMovedCablesAndRefusesTheCalibration) {
  HeadingTrialOptions options = trialOptions(120.0);
  options.currents->moved_rad = 0.6;
  const HeadingTrial moved = runHeadingTrial(options);
  EXPECT_EQ(moved.findings.count("current_compensation_wrong"), 1);
  EXPECT_GT(moved.current_status.at("refused"), 300);
  options.estimator.magnetometer.use = MagnetometerUse::Off;
  const HeadingTrial off = runHeadingTrial(options);
  EXPECT_LT(moved.alignedRms(kSettled_s), 1.1 * off.alignedRms(kSettled_s) + 0.02 * kDegree);
  EXPECT_LT(moved.rms(kSettled_s), 0.5 * kDegree);
}

TEST(MagnetometerWithCurrents, UsesNoReadingInAGapOfTheCurrents) {
  HeadingTrialOptions options = trialOptions(50.0);
  options.currents->gap_begin_s = 25.0;
  options.currents->gap_s = 10.0;
  const HeadingTrial trial = runHeadingTrial(options);
  EXPECT_NEAR(trial.current_status.at("missing"), 36, 4);
  EXPECT_EQ(trial.findings.count("current_missing"), 1);
  EXPECT_LT(trial.rms(kSettled_s), 0.5 * kDegree);
}

TEST(MagnetometerWithCurrents, TakesManyChannelsAsConstants) {
  HeadingTrialOptions options = trialOptions(60.0);
  options.currents->thrusters = 13;
  options.currents->calibration_sigma_T_per_A = 0.002e-6;
  const HeadingTrial trial = runHeadingTrial(options);
  EXPECT_LT(trial.rms(kSettled_s), 0.5 * kDegree);
  EXPECT_GT(trial.share(MagnetometerStatus::Used), 0.9);
}

}  // namespace
}  // namespace lodeline

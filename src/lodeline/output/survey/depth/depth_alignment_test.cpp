#include "lodeline/output/survey/depth/depth_alignment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

/// Depth of a synthetic dive, `t` in s: descent, varying depth, ascent.
double depthOfDive(double t) {
  const double ramp = std::clamp(t / 120.0, 0.0, 1.0) * std::clamp((1800.0 - t) / 200.0, 0.0, 1.0);
  return 15.0 * ramp + 3.0 * std::sin(t / 70.0) * ramp + 1.5 * std::sin(t / 23.0) * ramp;
}

/// A run from `begin_s` to `end_s` of the dive, with a drift of the vertical.
RunFolder runOfDive(double begin_s, double end_s, double drift_m_per_s) {
  RunFolder run;
  for (double t = begin_s; t <= end_s; t += 0.1) {
    const double z = depthOfDive(begin_s) - depthOfDive(t) + drift_m_per_s * (t - begin_s);
    const Vec3 position(0.2 * (t - begin_s), 0.0, z);
    const Time time = Time::fromSeconds(1.795e9 + t);
    run.trajectory.poses.push_back({time, Rigid3(Quat::Identity(), position)});
    run.uncertainties.push_back({time, Mat3::Identity()});
    run.landmarks.push_back({position + Vec3(0.0, 2.0, 0.5), 3});
  }
  return run;
}

/// Profile of a dive computer: rounded readings at a constant interval, with its own time origin.
DepthProfile computerProfile(double interval_s, double resolution_m, unsigned seed = 0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, seed == 0 ? 0.0 : 0.05);
  DepthProfile profile;
  profile.resolution_m = resolution_m;
  for (double t = 0.0; t <= 1800.0; t += interval_s) {
    const double depth = depthOfDive(t) + noise(random);
    profile.readings.push_back({t, std::round(depth / resolution_m) * resolution_m});
  }
  return profile;
}

TEST(DepthAlignment, FindsLagAndDepthOfTheStart) {
  const RunFolder run = runOfDive(300.0, 1200.0, 0.0);
  for (double interval_s : {1.0, 5.0, 10.0}) {
    const DepthAlignment found =
        alignDepths(computerProfile(interval_s, 0.1, 7), run.trajectory, std::nullopt);
    EXPECT_NEAR(found.lag_s, 1.795e9, 1.0) << interval_s;
    EXPECT_NEAR(found.start_depth_m, depthOfDive(300.0), 0.05);
    EXPECT_LT(found.rms_m, 0.12);
    EXPECT_NEAR(found.slope, 1.0, 0.02);
    EXPECT_EQ(found.doubt, "");
    EXPECT_LT(std::abs(found.lag_s - 1.795e9), 4.0 * found.lag_sigma_s + 0.1);
  }
}

TEST(DepthAlignment, StandsAVerticalDriftAndStrayReadings) {
  const RunFolder run = runOfDive(200.0, 1500.0, 0.5 / 1300.0);
  DepthProfile profile = computerProfile(10.0, 0.1);
  for (size_t i = 7; i < profile.readings.size(); i += 15) profile.readings[i].depth_m += 20.0;
  const DepthAlignment found = alignDepths(profile, run.trajectory, std::nullopt);
  EXPECT_NEAR(found.lag_s, 1.795e9, 2.0);
  EXPECT_EQ(found.doubt, "");
}

TEST(DepthAlignment, TellsTheScaleOfAComputerSetForOtherWater) {
  const RunFolder run = runOfDive(20.0, 1700.0, 0.0);
  DepthProfile profile = computerProfile(5.0, 0.01);
  for (DepthReading& reading : profile.readings) reading.depth_m *= 0.975;
  EXPECT_NEAR(alignDepths(profile, run.trajectory, std::nullopt).slope, 0.975, 0.003);
}

TEST(DepthAlignment, SaysWhenTheLagCannotBeTold) {
  RunFolder level = runOfDive(300.0, 900.0, 0.0);
  for (StampedPose& pose : level.trajectory.poses) pose.world_from_body.translation.z() = 0.0;
  EXPECT_NE(alignDepths(computerProfile(10.0, 0.1), level.trajectory, std::nullopt).doubt, "");
  // A periodic profile fits at many lags.
  RunFolder waves = runOfDive(300.0, 900.0, 0.0);
  for (StampedPose& pose : waves.trajectory.poses) {
    pose.world_from_body.translation.z() = std::sin(pose.time.seconds() / 10.0);
  }
  DepthProfile repeating = computerProfile(1.0, 0.1);
  for (DepthReading& reading : repeating.readings) reading.depth_m = 10.0 - std::sin(reading.time_s / 10.0);
  EXPECT_NE(alignDepths(repeating, waves.trajectory, std::nullopt).doubt, "");
  // Another dive.
  DepthProfile other = computerProfile(10.0, 0.1);
  for (DepthReading& reading : other.readings) reading.depth_m = 8.0 + 3.0 * std::cos(reading.time_s / 31.0);
  EXPECT_NE(alignDepths(other, runOfDive(0.0, 1700.0, 0.0).trajectory, std::nullopt).doubt, "");
}

TEST(DepthAlignment, TakesAStatedLagAndRefusesOneWithoutOverlap) {
  const RunFolder run = runOfDive(300.0, 900.0, 0.0);
  const DepthProfile profile = computerProfile(5.0, 0.1);
  EXPECT_EQ(alignDepths(profile, run.trajectory, 1.795e9 + 3.0).lag_s, 1.795e9 + 3.0);
  EXPECT_THROW(alignDepths(profile, run.trajectory, 0.0), InputError);
}

TEST(DepthCorrection, TakesTheDriftOutAndKeepsTheDetail) {
  RunFolder run = runOfDive(300.0, 1500.0, 1.2 / 1200.0);
  const DepthProfile profile = computerProfile(5.0, 0.1, 3);
  const DepthAlignment alignment = alignDepths(profile, run.trajectory, std::nullopt);
  const double start_depth_m = correctDepths(profile, alignment, &run);
  EXPECT_NEAR(start_depth_m, depthOfDive(300.0), 0.1);
  EXPECT_NEAR(run.trajectory.poses.front().world_from_body.translation.z(), 0.0, 1e-12);
  double worst_m = 0.0, square_sum = 0.0;
  for (size_t i = 0; i < run.trajectory.size(); ++i) {
    const double depth_m = start_depth_m - run.trajectory.poses[i].world_from_body.translation.z();
    const double error_m = depth_m - depthOfDive(300.0 + 0.1 * static_cast<double>(i));
    worst_m = std::max(worst_m, std::abs(error_m));
    square_sum += error_m * error_m;
    // Landmarks move with the poses.
    EXPECT_NEAR(run.landmarks[i].position.z() - run.trajectory.poses[i].world_from_body.translation.z(), 0.5,
                0.05);
  }
  EXPECT_LT(worst_m, 0.2);
  EXPECT_LT(std::sqrt(square_sum / static_cast<double>(run.trajectory.size())), 0.06);
  EXPECT_LT(std::sqrt(run.uncertainties.back().covariance(2, 2)), 0.2);
  EXPECT_EQ(run.uncertainties.back().covariance(0, 0), 1.0);
}

}  // namespace
}  // namespace lodeline

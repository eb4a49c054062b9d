#include "lodeline/output/survey/depth/profile_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace lodeline {
namespace {

using ::testing::HasSubstr;

double depthAfter(double t) { return 9.0 - 6.0 * std::cos(t / 45.0) + 1.5 * std::sin(t / 19.0); }

Trajectory runOfDive(double begin_s = 20.0) {
  Trajectory run;
  for (double t = begin_s; t <= begin_s + 240.0; t += 0.5) {
    const Vec3 position(0.1 * t, 0.0, depthAfter(begin_s) - depthAfter(t));
    run.poses.push_back({Time::fromSeconds(1.795e9 + t), Rigid3(Quat::Identity(), position)});
  }
  return run;
}

/// The dive in a unit; `shape` 1 is the run's own.
DepthProfile profile(double units_per_metre, bool has_unit, double shape = 1.0) {
  DepthProfile result;
  result.name = "computer.csv";
  result.has_unit = has_unit;
  result.resolution_m = 0.1 * units_per_metre;
  for (double t = 0.0; t <= 300.0; t += 10.0)
    result.readings.push_back({t, std::round(depthAfter(shape * t) * 10.0) / 10.0 * units_per_metre});
  return result;
}

TEST(ProfileFit, TakesTheUnitThatFitsWhereNoneIsStated) {
  for (double units_per_metre : {1.0 / 0.3048, 100.0, 1000.0}) {
    Diagnostics diagnostics;
    const ProfileFit fit =
        fitProfile({profile(units_per_metre, false)}, runOfDive(), std::nullopt, &diagnostics);
    EXPECT_EQ(fit.alignment.doubt, "") << units_per_metre;
    EXPECT_NEAR(fit.alignment.start_depth_m, depthAfter(20.0), 0.1);
    EXPECT_NEAR(fit.alignment.slope, 1.0, 0.02);
    EXPECT_NEAR(fit.alignment.lag_s, 1.795e9, 1.0);
    EXPECT_EQ(diagnostics.count("profile_unit"), 1);
  }
}

TEST(ProfileFit, DoubtsAStatedUnitThatDoesNotFit) {
  for (double units_per_metre : {1.0 / 0.3048, 0.3048, 100.0, 0.01, 1000.0, 0.001}) {
    Diagnostics diagnostics;
    const ProfileFit fit =
        fitProfile({profile(units_per_metre, true)}, runOfDive(), std::nullopt, &diagnostics);
    EXPECT_THAT(fit.alignment.doubt, HasSubstr("unit")) << units_per_metre;
    const ProfileFit known = fitProfile({profile(units_per_metre, true)}, runOfDive(), 1.795e9, &diagnostics);
    EXPECT_THAT(known.alignment.doubt, HasSubstr("unit")) << units_per_metre;
  }
}

TEST(ProfileFit, SaysNothingOfAProfileThatFits) {
  for (bool has_unit : {true, false}) {
    Diagnostics diagnostics;
    const ProfileFit fit = fitProfile({profile(1.0, has_unit)}, runOfDive(), std::nullopt, &diagnostics);
    EXPECT_EQ(fit.alignment.doubt, "");
    EXPECT_NEAR(fit.alignment.start_depth_m, depthAfter(20.0), 0.1);
    EXPECT_TRUE(diagnostics.ranked().empty());
  }
}

TEST(ProfileFit, ChoosesTheDiveThatFits) {
  Diagnostics diagnostics;
  DepthProfile other = profile(1.0, true, 0.37), right = profile(1.0, true);
  other.dive = "lines 2 to 32";
  other.dive_number = 1;
  right.dive = "lines 33 to 63";
  right.dive_number = 2;
  const ProfileFit fit = fitProfile({other, right}, runOfDive(), std::nullopt, &diagnostics);
  EXPECT_EQ(fit.profile.dive, "lines 33 to 63");
  EXPECT_EQ(fit.alignment.doubt, "");
  EXPECT_EQ(diagnostics.count("profile_dives"), 1);
  DepthProfile twin = right;
  twin.dive_number = 3;
  EXPECT_THAT(fitProfile({right, twin}, runOfDive(), std::nullopt, &diagnostics).alignment.doubt,
              HasSubstr("alike"));
  twin.dive_number = right.dive_number;  // two computers of one diver
  EXPECT_EQ(fitProfile({right, twin}, runOfDive(), std::nullopt, &diagnostics).alignment.doubt, "");
}

TEST(ProfileFit, DoubtsWhatCoversLittleOfTheRunOrLiesAboveTheWater) {
  Diagnostics diagnostics;
  DepthProfile minutes = profile(1.0, false);  // minutes that were read as seconds
  for (DepthReading& reading : minutes.readings) reading.time_s /= 60.0;
  EXPECT_NE(fitProfile({minutes}, runOfDive(), std::nullopt, &diagnostics).alignment.doubt, "");
  DepthProfile heights = profile(1.0, true);
  for (DepthReading& reading : heights.readings) reading.depth_m -= 20.0;
  EXPECT_THAT(fitProfile({heights}, runOfDive(), std::nullopt, &diagnostics).alignment.doubt,
              HasSubstr("above the water"));
}

TEST(ProfileFit, DoubtsWhatDoesNotChangeAsTheRunDoes) {
  Diagnostics diagnostics;
  DepthProfile average = profile(1.0, true);
  double sum = 0.0;
  for (size_t i = 0; i < average.readings.size(); ++i) {
    sum += average.readings[i].depth_m;
    average.readings[i].depth_m = sum / static_cast<double>(i + 1);
  }
  EXPECT_NE(fitProfile({average}, runOfDive(), std::nullopt, &diagnostics).alignment.doubt, "");
}

}  // namespace
}  // namespace lodeline

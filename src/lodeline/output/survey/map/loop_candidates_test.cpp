#include "lodeline/output/survey/map/loop_candidates.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {

/// In along x with legs of 5 m, and back beside the way in.
Survey inAndOut(const Vec3& beside, double leg_sigma_m) {
  Survey survey;
  for (int i = 0; i <= 20; ++i) {
    SurveyStation station;
    station.position_ENU =
        i <= 10 ? Vec3(5.0 * i, 0.0, 0.0) : Vec3(Vec3(5.0 * (20 - i), 0.0, 0.0) + 0.1 * (i - 10) * beside);
    survey.stations.push_back(station);
  }
  survey.leg_sigma_ENU = Vec3::Constant(leg_sigma_m);
  return survey;
}

TEST(LoopCandidates, TheWayBackComesBackToTheWayOut) {
  const Survey survey = inAndOut(Vec3(0.0, 0.6, -0.8), 0.1);
  const std::vector<LoopCandidate> loops = findLoopCandidates(survey);
  ASSERT_EQ(loops.size(), 1U);
  const LoopCandidate& loop = loops.front();
  EXPECT_EQ(loop.first, 12U);  // the station before has less than 15 m of way behind it to the same place
  EXPECT_EQ(loop.last, 20U);
  EXPECT_EQ(loop.station, 20U);
  EXPECT_EQ(loop.leg, 0U);
  EXPECT_NEAR((loop.misclosure_ENU - Vec3(0.0, 0.6, -0.8)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(loop.length_m, survey.length_m(), 1e-9);
  EXPECT_NEAR(loop.percent(), 1.0, 0.01);
  EXPECT_NEAR(loop.sigma_ENU.x(), std::sqrt(20 * 0.1 * 0.1 + 0.25), 1e-9);
  EXPECT_NEAR(loop.median_misclosure_m, 0.6, 1e-9);
}

TEST(LoopCandidates, WhatIsFartherThanItsUncertaintyIsAnotherPlace) {
  EXPECT_TRUE(findLoopCandidates(inAndOut(Vec3(0.0, 0.0, 40.0), 0.02)).empty());
  EXPECT_FALSE(findLoopCandidates(inAndOut(Vec3(0.0, 0.0, 8.0), 2.0)).empty());
}

TEST(LoopCandidates, AStraightOrHoveringWayHasNone) {
  Survey survey;
  for (int i = 0; i < 12; ++i) {
    survey.stations.emplace_back();
    survey.stations.back().position_ENU = Vec3(5.0 * i, 0.0, 0.0);
  }
  survey.leg_sigma_ENU = Vec3::Constant(0.5);
  EXPECT_TRUE(findLoopCandidates(survey).empty());
}

TEST(LoopCandidates, TellsCrossingsApartLongestFirst) {
  Survey survey;
  // A loop around a block of 20 m, then one around another of 10 m.
  for (const Vec3& corner :
       {Vec3(0, 0, 0), Vec3(20, 0, 0), Vec3(20, 20, 0), Vec3(0, 20, 0), Vec3(0, 0.2, 0), Vec3(-30, 0, 0),
        Vec3(-40, 0, 0), Vec3(-40, -10, 0), Vec3(-30, -10, 0), Vec3(-30, 0.3, 0)}) {
    survey.stations.emplace_back();
    survey.stations.back().position_ENU = corner;
  }
  survey.leg_sigma_ENU = Vec3::Constant(0.1);
  const std::vector<LoopCandidate> loops = findLoopCandidates(survey);
  ASSERT_EQ(loops.size(), 2U);
  EXPECT_EQ(loops[0].station, 4U);
  EXPECT_NEAR(loops[0].length_m, 79.8, 0.1);
  EXPECT_EQ(loops[1].station, 9U);
  EXPECT_NEAR(loops[1].length_m, 40.3, 0.1);
}

}  // namespace
}  // namespace lodeline

#include "lodeline/output/survey/map/passage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lodeline/output/survey/map/test_dive.h"

namespace lodeline {
namespace {

/// A straight passage along `along`, wide and low: 3 m to the left, 2 m to the right, 1 m up and 1.5 m down
/// from the line.
std::vector<Vec3> boxWalls(const Vec3& along, std::mt19937* random) {
  const Vec3 left = Vec3::UnitZ().cross(along);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<Vec3> walls;
  for (int i = 0; i < 4000; ++i) {
    const double s = 20.0 * uniform(*random), across = -2.0 + 5.0 * uniform(*random);
    const double height = -1.5 + 2.5 * uniform(*random);
    walls.push_back(s * along + 3.0 * left + height * Vec3::UnitZ());
    walls.push_back(s * along - 2.0 * left + height * Vec3::UnitZ());
    walls.push_back(s * along + across * left + 1.0 * Vec3::UnitZ());
    walls.push_back(s * along + across * left - 1.5 * Vec3::UnitZ());
  }
  return walls;
}

Survey straightSurvey(const Vec3& along) {
  Survey survey;
  for (int i = 0; i <= 4; ++i) {
    survey.stations.emplace_back();
    survey.stations.back().position_ENU = 5.0 * i * along;
  }
  return survey;
}

TEST(Passage, IsMeasuredAcrossTheLine) {
  std::mt19937 random(3);
  for (double azimuth : {0.3, 2.0, 4.4}) {
    const Vec3 along(std::sin(azimuth), std::cos(azimuth), 0.0);
    Survey survey = straightSurvey(along);
    measurePassage(boxWalls(along, &random), {}, &survey);
    const PassageSize& size = survey.stations[2].passage;
    ASSERT_TRUE(size.isComplete());
    EXPECT_NEAR(*size.left, 3.0, 0.05);
    EXPECT_NEAR(*size.right, 2.0, 0.05);
    EXPECT_NEAR(*size.up, 1.0, 0.02);
    EXPECT_NEAR(*size.down, 1.5, 0.02);
  }
}

TEST(Passage, IsNotMovedByAFifthOfStrayPoints) {
  std::mt19937 random(4);
  std::vector<Vec3> walls = boxWalls(Vec3::UnitX(), &random);
  std::normal_distribution<double> normal;
  for (size_t i = 0; i < walls.size(); i += 5) {
    walls[i] += 2.0 * Vec3(0.0, normal(random), normal(random));
  }
  Survey survey = straightSurvey(Vec3::UnitX());
  measurePassage(walls, {}, &survey);
  EXPECT_NEAR(*survey.stations[2].passage.left, 3.0, 0.1);
  EXPECT_NEAR(*survey.stations[2].passage.down, 1.5, 0.1);
}

TEST(Passage, IsUnknownWhereNoWallWasSeen) {
  std::mt19937 random(5);
  std::vector<Vec3> walls;
  for (const Vec3& wall : boxWalls(Vec3::UnitX(), &random)) {
    if (wall.z() < 0.9) walls.push_back(wall);
  }
  Survey survey = straightSurvey(Vec3::UnitX());
  measurePassage(walls, {}, &survey);
  EXPECT_FALSE(survey.stations[2].passage.up);
  EXPECT_TRUE(survey.stations[2].passage.down);
  EXPECT_FALSE(survey.stations[2].passage.isComplete());
  Survey alone = straightSurvey(Vec3::UnitX());
  measurePassage({}, {}, &alone);
  EXPECT_FALSE(alone.stations[2].passage.left);
  EXPECT_TRUE(alone.stations[2].splays_ENU.empty());
}

TEST(Passage, IsMeasuredAcrossTheWayInWhereTheDiveTurnsRound) {
  Survey survey = straightSurvey(Vec3::UnitX());
  // The way back begins 3 m beside the way in: the mean of both directions points to that side.
  for (int i = 4; i >= 0; --i) {
    survey.stations.emplace_back();
    survey.stations.back().position_ENU = Vec3(5.0 * i, 3.0 * (i < 4 ? 1.0 : 0.4), 0.0);
  }
  survey.stations.erase(survey.stations.begin() + 5);
  const std::vector<PassageSection> sections = passageSections(survey.stations);
  EXPECT_LT((sections[4].along - Vec3::UnitX()).norm(), 1e-12);
  EXPECT_LT((sections[4].left - Vec3::UnitY()).norm(), 1e-12);
  EXPECT_LT(sections[6].along.x(), -0.9);

  // A bend of less than a right angle keeps the mean direction.
  Survey bend;
  for (const Vec3& position : {Vec3(0.0, 0.0, 0.0), Vec3(5.0, 0.0, 0.0), Vec3(6.0, 5.0, 0.0)}) {
    bend.stations.emplace_back();
    bend.stations.back().position_ENU = position;
  }
  const Vec3 along = passageSections(bend.stations)[1].along;
  EXPECT_NEAR(std::atan2(along.y(), along.x()), 0.5 * std::atan2(5.0, 1.0), 1e-9);
}

TEST(Splays, GoToPointsOfTheMapAllAround) {
  const RunFolder run = test::windingDive(40.0);
  std::vector<Vec3> walls;
  for (const MapLandmark& landmark : run.landmarks) walls.push_back(landmark.position);
  Survey survey;
  for (int i = 0; i <= 8; ++i) {
    survey.stations.emplace_back();
    survey.stations.back().position_ENU = test::wayAt(5.0 * i);
  }
  measurePassage(walls, {}, &survey);
  const SurveyStation& station = survey.stations[4];
  EXPECT_EQ(station.splays_ENU.size(), 16U);
  for (const Vec3& splay : station.splays_ENU) {
    EXPECT_NEAR((splay - station.position_ENU).norm(), 2.0, 0.7);
    EXPECT_TRUE(std::any_of(walls.begin(), walls.end(),
                            [&](const Vec3& wall) { return (wall - splay).norm() < 1e-9; }));
  }
}

TEST(Passage, OfAShaftHasNoNumbersThatAreNone) {
  Survey survey;
  for (int i = 0; i <= 3; ++i) {
    survey.stations.emplace_back();
    survey.stations.back().position_ENU = Vec3(0.0, 0.0, -5.0 * i);
  }
  std::vector<Vec3> walls;
  for (int i = 0; i < 2000; ++i) walls.push_back({2.0 * std::cos(i), 2.0 * std::sin(i), -0.0075 * i});
  measurePassage(walls, {}, &survey);
  ASSERT_TRUE(survey.stations[1].passage.left);
  EXPECT_NEAR(*survey.stations[1].passage.left, 1.9, 0.1);
}

}  // namespace
}  // namespace lodeline

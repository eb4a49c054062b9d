#include "lodeline/output/survey/map/survey.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

/// Points at intervals of 0.1 m on straight lines between corners.
std::vector<Vec3> wayAlong(const std::vector<Vec3>& corners) {
  std::vector<Vec3> way = {corners.front()};
  for (size_t i = 1; i < corners.size(); ++i) {
    const Vec3 side = corners[i] - corners[i - 1];
    const auto steps = static_cast<int>(std::lround(side.norm() / 0.1));
    for (int k = 1; k <= steps; ++k) way.push_back(corners[i - 1] + side * k / steps);
  }
  return way;
}

std::vector<Vec3> stationsOf(const std::vector<Vec3>& way) {
  std::vector<Vec3> stations;
  for (size_t i : chooseStations(way, {})) stations.push_back(way[i]);
  return stations;
}

Survey surveyOf(const std::vector<Vec3>& positions) {
  Survey survey;
  for (const Vec3& position : positions) {
    survey.stations.emplace_back();
    survey.stations.back().position_ENU = position;
  }
  return survey;
}

TEST(Stations, StandEachFiveMetresOnAStraightWay) {
  const std::vector<Vec3> stations = stationsOf(wayAlong({{0, 0, 0}, {32, 0, 0}}));
  ASSERT_EQ(stations.size(), 8U);
  for (size_t i = 1; i + 1 < stations.size(); ++i)
    EXPECT_NEAR(stations[i].x() - stations[i - 1].x(), 5.0, 0.3);
  EXPECT_NEAR(stations.back().x(), 32.0, 1e-9);
}

TEST(Stations, StandAtTheCornerOfABend) {
  const std::vector<Vec3> stations = stationsOf(wayAlong({{0, 0, 0}, {3.5, 0, 0}, {3.5, 4.0, 0}}));
  ASSERT_EQ(stations.size(), 3U);
  EXPECT_NEAR((stations[1] - Vec3(3.5, 0, 0)).norm(), 0.0, 0.3);
}

TEST(Stations, LeaveBendsOfLessThanTwentyDegreesAndShortLegsAlone) {
  const double turn = 15.0 * M_PI / 180.0;
  EXPECT_EQ(stationsOf(wayAlong({{0, 0, 0}, {3, 0, 0}, {3 + 1.9 * std::cos(turn), 1.9 * std::sin(turn), 0}}))
                .size(),
            2U);
  EXPECT_EQ(stationsOf(wayAlong({{0, 0, 0}, {1.5, 0, 0}, {1.5, 1.4, 0}})).size(), 2U);
}

TEST(Stations, StandWhereTheDiverTurnsBack) {
  for (const double length_m : {2.2, 2.6, 4.1, 7.4, 13.3, 16.9}) {
    // The way back is a little beside the way in.
    const std::vector<Vec3> stations =
        stationsOf(wayAlong({{0, 0, 0}, {length_m, 0, 0}, {length_m - 0.1, 0.3, 0}, {0.1, 0.3, 0}}));
    double farthest_m = 0.0;
    for (const Vec3& station : stations) farthest_m = std::max(farthest_m, station.x());
    EXPECT_NEAR(farthest_m, length_m, 0.5) << length_m;
  }
}

TEST(Stations, DoNotMultiplyWhileTheDiverHovers) {
  std::vector<Vec3> way = wayAlong({{0, 0, 0}, {4, 0, 0}});
  for (int i = 0; i < 5000; ++i) way.push_back(Vec3(4.0 + 0.05 * std::sin(i), 0.05 * std::cos(1.7 * i), 0.0));
  EXPECT_EQ(stationsOf(way).size(), 2U);
}

TEST(Stations, AreRefusedWhereNothingMoved) {
  EXPECT_THROW(chooseStations({Vec3::Zero()}, {}), InputError);
  EXPECT_THROW(chooseStations(std::vector<Vec3>(100, Vec3::Zero()), {}), InputError);
}

TEST(LegSigma, OfAllLegsTogetherIsThatOfTheEnd) {
  const Vec3 end(0.3, 0.2, 0.1);
  EXPECT_LT((legSigma(end, 25) * 5.0 - end).norm(), 1e-12);
  EXPECT_DOUBLE_EQ(legSigma(Vec3::Zero(), 4).x(), 1e-3);
}

TEST(Misclosure, IsTheEndFromTheStartAndTheWaysFromEachOther) {
  const Survey survey = surveyOf({{0, 0, 0}, {10, 0, -1}, {20, 0, -2}, {10, 0.5, -0.8}, {0.3, 0.4, 0}});
  const Misclosure closure = misclosure(survey);
  EXPECT_NEAR(closure.end_from_start_ENU.norm(), 0.5, 1e-12);
  EXPECT_NEAR(closure.percent(), 100.0 * 0.5 / survey.length_m(), 1e-12);
  ASSERT_TRUE(closure.horizontal_between_ways_m);
  EXPECT_NEAR(*closure.horizontal_between_ways_m, 0.45, 0.05);
  EXPECT_FALSE(misclosure(surveyOf({{0, 0, 0}, {10, 0, 0}, {20, 0, 0}})).horizontal_between_ways_m);
}

}  // namespace
}  // namespace lodeline

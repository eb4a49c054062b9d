#include "simulation/rendering/cave/centerline.h"

#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

CenterlineOptions options(uint64_t seed) {
  CenterlineOptions o;
  o.seed = seed;
  o.length_m = 150.0;
  return o;
}

TEST(Centerline, StartsAtTheOriginAndDescendsAsAsked) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const Centerline line = Centerline::generate(options(seed));
    EXPECT_LT(line.at(0.0).position_W.norm(), 1e-12);
    const double descent = -line.at(150.0).position_W.z();
    EXPECT_NEAR(descent, 8.0, 4.0) << seed;
    EXPECT_LE(line.beginArcLength(), -12.0);
    EXPECT_GE(line.endArcLength(), 165.0);
  }
}

TEST(Centerline, ArcLengthIsTheLengthOfTheCurve) {
  const Centerline line = Centerline::generate(options(3));
  double length = 0.0;
  for (int i = 0; i < 1500; ++i) {
    length += (line.at(0.1 * (i + 1)).position_W - line.at(0.1 * i).position_W).norm();
  }
  EXPECT_NEAR(length, 150.0, 0.005);
}

TEST(Centerline, NeverComesCloseToItself) {
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const auto stations = Centerline::generate(options(seed)).stations();
    for (size_t i = 0; i < stations.size(); i += 4) {
      for (size_t j = i; j < stations.size(); j += 4) {
        if (stations[j].arc_length_m - stations[i].arc_length_m < 20.0) continue;
        EXPECT_GT((stations[i].position_W - stations[j].position_W).norm(), 5.0) << seed;
      }
    }
  }
}

TEST(Centerline, WindsAndChangesItsSection) {
  const Centerline line = Centerline::generate(options(2));
  double least_width = 1e9, most_width = 0.0, least_turn = 1.0;
  for (const PassageStation& station : line.stations()) {
    least_width = std::min(least_width, station.width_m);
    most_width = std::max(most_width, station.width_m);
    least_turn = std::min(least_turn, station.tangent_W.dot(line.stations().front().tangent_W));
  }
  EXPECT_LT(least_turn, 0.8);
  EXPECT_GT(most_width / least_width, 1.5);
  EXPECT_GT(least_width, 1.2);
}

TEST(Centerline, SameSeedSamePassageOtherSeedOtherPassage) {
  const Vec3 a = Centerline::generate(options(4)).at(90.0).position_W;
  EXPECT_EQ(a, Centerline::generate(options(4)).at(90.0).position_W);
  EXPECT_GT((a - Centerline::generate(options(5)).at(90.0).position_W).norm(), 1.0);
}

TEST(Centerline, FindsTheNearestStation) {
  const Centerline line = Centerline::generate(options(1));
  EXPECT_NEAR(line.nearestArcLength(line.at(40.0).position_W + Vec3(0, 0, 0.3), 38.0, 5.0), 40.0, 0.3);
}

TEST(Centerline, RefusesLengthsThatMakeNoPassage) {
  CenterlineOptions o;
  o.length_m = -1.0;
  EXPECT_THROW(Centerline::generate(o), UsageError);
  o = CenterlineOptions();
  o.mean_width_m = std::nan("");
  EXPECT_THROW(Centerline::generate(o), UsageError);
}

}  // namespace
}  // namespace lodeline

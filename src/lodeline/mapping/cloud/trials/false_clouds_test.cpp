#include <gtest/gtest.h>

#include <cstdio>

#include "lodeline/mapping/cloud/trials/test_cloud_pairs.h"

namespace lodeline {
namespace {

using test::cloudAt;
using test::Drift;
using test::PlacedCloud;
using test::Tube;
using test::TubeWorld;

struct FalsePairs {
  int tried = 0;
  int verified = 0;
  int wrong = 0;  ///< more than three claimed sigmas along a direction of the information
};

/// Pairs of different places of one passage, which the prediction claims to be the same place. All pairs of
/// clouds that are at least 6 m apart, looking the same way or back.
FalsePairs falsePairs(const Tube& tube, int most_pairs) {
  constexpr double kSpacing_m = 3.0;
  std::mt19937_64 random(tube.seed);
  const TubeWorld world(tube);
  std::vector<PlacedCloud> places;
  std::vector<double> along;
  for (double s = 5.0; s <= tube.length_m - 5.0; s += kSpacing_m) {
    const bool looks_back = places.size() % 2 == 1;
    along.push_back(s);
    places.push_back(cloudAt(world, s, looks_back, {}, random));
  }
  FalsePairs result;
  for (size_t i = 0; i < places.size(); ++i) {
    for (size_t j = 0; j < places.size() && result.tried < most_pairs; ++j) {
      if (std::abs(along[i] - along[j]) < 6.0) continue;
      const Rigid3 truth = places[i].world_from_frame.inverse() * places[j].world_from_frame;
      const Rigid3 claimed = places[i].world_from_frame.inverse() * world.body(along[i], j % 2 == 1);
      const Drift drift{.horizontal_m = 0.1 + 0.1 * static_cast<double>(result.tried % 5)};
      const CloudRegistration registration = registerClouds(
          places[i].cloud, places[j].cloud, test::drifted(claimed, drift, random), test::covarianceOf(drift));
      ++result.tried;
      if (registration.loop.status != LoopStatus::Verified) continue;
      ++result.verified;
      if (test::worstError(registration, truth) > 3.0) ++result.wrong;
    }
  }
  return result;
}

void expectNoneWrong(const Tube& tube, int most_pairs) {
  const FalsePairs pairs = falsePairs(tube, most_pairs);
  EXPECT_EQ(pairs.tried, most_pairs);
  EXPECT_EQ(pairs.wrong, 0) << pairs.verified << " verified";
  std::printf("%d false pairs, %d verified, %d wrong\n", pairs.tried, pairs.verified, pairs.wrong);
}

Tube passageOfLength(double length_m, unsigned seed) {
  Tube tube;
  tube.length_m = length_m;
  tube.seed = seed;
  return tube;
}

TEST(FalseClouds, OfOnePassageAreRefused) { expectNoneWrong(passageOfLength(60.0, 21), 80); }

TEST(FalseClouds, OfAStraightPassageAreRefused) {
  Tube tube = passageOfLength(40.0, 22);
  tube.bend_rad = 0.0;
  expectNoneWrong(tube, 40);
}

TEST(FalseClouds, OfASmoothPassageAreRefused) {
  Tube tube = passageOfLength(40.0, 23);
  tube.bend_rad = 0.0;
  tube.bump_m = 0.0;
  expectNoneWrong(tube, 20);
}

TEST(FalseClouds, OfTwoParallelWallsAreRefused) {
  Tube tube = passageOfLength(40.0, 24);
  tube.bend_rad = 0.0;
  tube.has_two_walls = true;
  expectNoneWrong(tube, 20);
}

TEST(FalseClouds, OfOneProfileAreRefused) {
  Tube tube = passageOfLength(40.0, 25);
  tube.bend_rad = 0.0;
  tube.is_extruded = true;
  expectNoneWrong(tube, 20);
}

/// Walls so even that other places of the passage fit nearly as well.
Tube evenPassageOfLength(double length_m, unsigned seed) {
  Tube tube = passageOfLength(length_m, seed);
  tube.bump_m = 0.1;
  tube.bend_rad = 0.2;
  return tube;
}

TEST(FalseClouds, OfAnEvenPassageAreRefused) { expectNoneWrong(evenPassageOfLength(60.0, 32), 100); }

// Takes minutes; `make loops` runs it.
TEST(FalseClouds, DISABLED_OfAThousandPairsAreRefused) {
  expectNoneWrong(passageOfLength(120.0, 31), 600);
  expectNoneWrong(evenPassageOfLength(120.0, 32), 600);
}

}  // namespace
}  // namespace lodeline

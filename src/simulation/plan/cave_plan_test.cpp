#include "simulation/plan/cave_plan.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/diagnostics.h"
#include "simulation/rendering/cave/passage_shapes.h"
#include "simulation/rendering/light/render_world.h"
#include "simulation/shared/random.h"

namespace lodeline {
namespace {

CavePlanOptions planOf(CaveShape shape, uint64_t seed = 1) {
  CavePlanOptions options;
  options.shape = shape;
  options.seed = seed;
  options.path_length_m = shape == CaveShape::Room ? 85.0 : 150.0;
  return options;
}

TEST(Circuit, ClosesWithoutSeamInPositionDirectionAndSection) {
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const Centerline ring = makeCircuit({.seed = seed, .length_m = 75.0});
    EXPECT_NEAR(ring.length_m(), 75.0, 0.01);
    const PassageStation begin = ring.at(1e-6), end = ring.at(ring.length_m() - 1e-6);
    EXPECT_LT((begin.position_W - end.position_W).norm(), 1e-5) << seed;
    EXPECT_LT((begin.tangent_W - end.tangent_W).norm(), 1e-4) << seed;
    EXPECT_NEAR(begin.width_m, end.width_m, 1e-4) << seed;
    EXPECT_NEAR(begin.height_m, end.height_m, 1e-4) << seed;
    const PassageStation lap = ring.at(10.0 + 2.0 * ring.length_m());
    EXPECT_LT((ring.at(10.0).position_W - lap.position_W).norm(), 1e-9);
    EXPECT_EQ(lap.arc_length_m, 10.0 + 2.0 * ring.length_m());
  }
}

TEST(Circuit, BendsGentlyAndStaysAwayFromItself) {
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const Centerline ring = makeCircuit({.seed = seed, .length_m = 75.0});
    double lowest_m = 1e9, highest_m = -1e9;
    for (double s = 0.0; s < ring.length_m(); s += 0.5) {
      const PassageStation here = ring.at(s), next = ring.at(s + 0.25);
      EXPECT_LT((next.tangent_W - here.tangent_W).norm() / 0.25, 1.0 / 4.0) << seed << " at " << s;
      EXPECT_NEAR((next.position_W - here.position_W).norm(), 0.25, 2e-3) << seed << " at " << s;
      lowest_m = std::min(lowest_m, here.position_W.z());
      highest_m = std::max(highest_m, here.position_W.z());
      for (double other = s + 18.0; other < s + ring.length_m() - 18.0; other += 1.0)
        EXPECT_GT((ring.at(other).position_W - here.position_W).norm(), 9.0) << seed;
    }
    EXPECT_GT(highest_m - lowest_m, 1.0) << seed;
  }
}

TEST(Circuit, RefusesOneThatIsTooShort) { EXPECT_THROW(makeCircuit({.length_m = 30.0}), UsageError); }

TEST(CavePlan, RoutesAreSmoothLinesFromTheOriginAndTurnOnlyWhereTracksAgree) {
  for (const CaveShape shape : {CaveShape::Passage, CaveShape::Loop, CaveShape::Junction, CaveShape::Room}) {
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      const CavePlan plan = planCave(planOf(shape, seed));
      EXPECT_LT(plan.route.trackOf(0).at(0.0).position_W.norm(), 1e-5);
      for (size_t k = 0; k < plan.route.legs.size(); ++k) {
        const SwimLeg& leg = plan.route.legs[k];
        const Centerline& track = plan.route.trackOf(static_cast<int>(k));
        const double way = leg.to_m > leg.from_m ? 1.0 : -1.0;
        for (double s = leg.from_m; way * (leg.to_m - s) > 0.5; s += 0.5 * way) {
          const PassageStation here = track.at(s), next = track.at(s + 0.25);
          EXPECT_NEAR((next.position_W - here.position_W).norm(), 0.25, 5e-3);
          EXPECT_LT((next.tangent_W - here.tangent_W).norm() / 0.25, 1.0)
              << static_cast<int>(shape) << " " << s;
          EXPECT_LT(std::abs(next.width_m - here.width_m), 0.6) << static_cast<int>(shape) << " " << s;
        }
        if (k == 0) continue;
        EXPECT_EQ(plan.route.legs[k - 1].to_m, leg.from_m);
        const PassageStation a = plan.route.trackOf(static_cast<int>(k) - 1).at(leg.from_m);
        const PassageStation b = track.at(leg.from_m);
        EXPECT_LT((a.position_W - b.position_W).norm(), 0.01);
        EXPECT_LT((a.tangent_W - b.tangent_W).norm(), 0.02);
      }
    }
  }
}

TEST(CavePlan, SecondEntranceIsTheFarEndOfTheSameCave) {
  CavePlanOptions options = planOf(CaveShape::Passage);
  options.path_length_m = 120.0;
  options.cave_length_m = 80.0;
  const CavePlan first = planCave(options);
  options.entrance = 2;
  const CavePlan second = planCave(options);
  const Centerline& in = first.route.trackOf(0);
  const Centerline& back = second.route.trackOf(0);
  EXPECT_EQ(in.at(33.0).position_W, first.cave.passages.front().at(33.0).position_W);
  EXPECT_LT((in.at(50.0).position_W - back.at(30.0).position_W).norm(), 1e-9);
  EXPECT_LT((in.at(50.0).tangent_W + back.at(30.0).tangent_W).norm(), 1e-6);
  EXPECT_GT(std::abs(back.at(0.0).position_W.z()), 1.0);
  options.path_length_m = 200.0;
  EXPECT_THROW(planCave(options), UsageError);
}

TEST(CavePlan, LapsKeepTheCircuit) {
  CavePlanOptions options = planOf(CaveShape::Loop, 3);
  const CavePlan two = planCave(options);
  options.laps = 3;
  options.path_length_m = 225.0;
  const CavePlan three = planCave(options);
  EXPECT_EQ(two.cave.passages[0].at(20.0).position_W, three.cave.passages[0].at(20.0).position_W);
  EXPECT_NEAR(three.route.length_m() - two.route.length_m(), 75.0, 0.02);
  options.laps = 0;
  EXPECT_THROW(planCave(options), UsageError);
}

/// Directions around a place of the corridor, all of which must meet a wall that is not close.
void expectFreeWay(const TracedScene& scene, const PassageStation& station, double least_m, Random& random) {
  const Vec3 right = station.tangent_W.cross(Vec3::UnitZ()).normalized();
  for (const double across : {-1.0, 0.0, 1.0}) {
    for (const double above : {-1.0, 0.0, 1.0}) {
      const Vec3 place = station.position_W +
                         across * 0.5 * kCorridorShareOfHalfWidth * station.width_m * right +
                         above * 0.5 * kCorridorShareOfHalfHeight * station.height_m * Vec3::UnitZ();
      for (int k = 0; k < 40; ++k) {
        const auto range = scene.range(place, random.direction());
        ASSERT_TRUE(range) << "a hole at " << station.arc_length_m;
        EXPECT_GT(*range, least_m) << "at " << station.arc_length_m;
      }
    }
  }
}

class CaveShapes : public testing::TestWithParam<CaveShape> {};

TEST_P(CaveShapes, HaveNoHolesAndNothingInTheWay) {
  const CavePlan plan = planCave(planOf(GetParam(), 2));
  CaveOptions options;
  options.style = CaveStyle::yucatanDecorated();
  options.seed = 2;
  options.max_triangles = 300'000;
  const TracedScene scene(makeCaveMesh(plan.cave, options));
  Random random(1, "test");
  for (size_t k = 0; k < plan.route.legs.size(); ++k) {
    const SwimLeg& leg = plan.route.legs[k];
    const double from_m = std::min(leg.from_m, leg.to_m), to_m = std::max(leg.from_m, leg.to_m);
    for (double s = from_m; s < to_m; s += 0.5)
      expectFreeWay(scene, plan.route.trackOf(static_cast<int>(k)).at(s), 0.1, random);
  }
}

INSTANTIATE_TEST_SUITE_P(All, CaveShapes,
                         testing::Values(CaveShape::Loop, CaveShape::Junction, CaveShape::Room));

TEST(CavePlan, PassagesJoinToOneSpace) {
  for (const CaveShape shape : {CaveShape::Loop, CaveShape::Junction}) {
    const CavePlan plan = planCave(planOf(shape, 1));
    CaveOptions options;
    options.max_triangles = 300'000;
    const TracedScene scene(makeCaveMesh(plan.cave, options));
    const Centerline& track = plan.route.trackOf(0);
    // No wall crosses the middle line of the track, on which both passages lie one after the other.
    for (double s = 0.0; s + 0.5 < plan.route.legs[0].to_m; s += 0.5) {
      const Vec3 step = track.at(s + 0.5).position_W - track.at(s).position_W;
      EXPECT_GT(*scene.range(track.at(s).position_W, step.normalized()), step.norm()) << s;
    }
  }
}

}  // namespace
}  // namespace lodeline

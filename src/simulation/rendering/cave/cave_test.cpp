#include <gtest/gtest.h>

#include <cmath>

#include "simulation/rendering/cave/cave_walls.h"
#include "simulation/rendering/light/render_world.h"
#include "simulation/rendering/test_render.h"
#include "simulation/shared/random.h"

namespace lodeline {
namespace {

/// Minimum range over directions all around.
double clearanceAt(const TracedScene& scene, const Vec3& point, Random& random) {
  double least = 1e9;
  for (int k = 0; k < 60; ++k) {
    const auto range = scene.range(point, random.direction());
    EXPECT_TRUE(range) << "the cave has a hole";
    if (range) least = std::min(least, *range);
  }
  return least;
}

class CaveStyles : public testing::TestWithParam<CaveStyle> {};

TEST_P(CaveStyles, LeavesTheDiversCorridorFree) {
  const Centerline passage = RenderFixture::shortPassage(25.0, 5);
  CaveOptions options;
  options.style = GetParam();
  options.seed = 5;
  options.max_triangles = 200'000;
  const TracedScene scene(makeCaveMesh(passage, options));
  Random random(1, "test");
  for (double s = 0.0; s < 25.0; s += 0.5) {
    const PassageStation station = passage.at(s);
    const Vec3 right = station.tangent_W.cross(Vec3::UnitZ()).normalized();
    const Vec3 up = right.cross(station.tangent_W);
    for (const double across : {-1.0, 0.0, 1.0}) {
      for (const double above : {-1.0, 0.0, 1.0}) {
        const double x = across * (kCorridorShareOfHalfWidth * 0.5 * station.width_m + kCorridorSway_m);
        const double z = above * (kCorridorShareOfHalfHeight * 0.5 * station.height_m + kCorridorSway_m);
        EXPECT_GT(clearanceAt(scene, station.position_W + x * right + z * up, random), 0.1)
            << "s " << s << " across " << across << " above " << above;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, CaveStyles,
                         testing::Values(CaveStyle::floridaSpring(), CaveStyle::yucatanDecorated()));

TEST(Cave, IsTheSameForTheSameSeed) {
  const Centerline passage = RenderFixture::shortPassage(8.0, 2);
  CaveOptions options;
  options.style = CaveStyle::yucatanDecorated();
  options.max_triangles = 40'000;
  const TriangleMesh first = makeCaveMesh(passage, options), again = makeCaveMesh(passage, options);
  EXPECT_EQ(first.positions, again.positions);
  EXPECT_EQ(first.triangles, again.triangles);
  const CaveWalls walls =
      makeCaveWalls(passage, options.style, options.seed, options.clearance_m, options.max_triangles);
  EXPECT_LT(walls.mesh.triangles.size(), 1.05 * options.max_triangles);
  options.seed = 2;
  EXPECT_NE(first.positions, makeCaveMesh(passage, options).positions);
}

TEST(Wreck, StandsOnTheSeabed) {
  WreckOptions options;
  options.center_W = Vec3f(5.0f, -3.0f, -20.0f);
  options.heading_rad = 0.0f;
  options.seabed_half_m = 20.0f;
  const TracedScene scene(makeWreck(options));
  const auto deck = scene.range(Vec3(6.0, -2.0, -10.0), -Vec3::UnitZ());
  const auto sand = scene.range(Vec3(5.0, 12.0, -10.0), -Vec3::UnitZ());
  const auto hull = scene.range(Vec3(5.0, 9.0, -19.0), -Vec3::UnitY());
  ASSERT_TRUE(deck && sand && hull);
  EXPECT_NEAR(*sand, 10.0, 0.9);
  EXPECT_LT(*deck, *sand - 1.0);
  EXPECT_NEAR(*hull, 9.0, 1.5);
}

}  // namespace
}  // namespace lodeline

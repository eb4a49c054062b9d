#include "lodeline/output/survey/cave/cave_paths.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

using Line = std::vector<Vec3>;

Line along(const Line& corners) {
  Line line = {corners.front()};
  for (size_t i = 1; i < corners.size(); ++i) {
    const Vec3 leg = corners[i] - corners[i - 1];
    const int steps = std::max(1, static_cast<int>(leg.norm() / 0.2));
    for (int k = 1; k <= steps; ++k) line.push_back(corners[i - 1] + leg * k / steps);
  }
  return line;
}

double lengthOf(const CavePaths& paths) {
  double length = 0.0;
  for (const CavePathBranch& b : paths.branches)
    length += paths.points[b.last].way_m - paths.points[b.first].way_m;
  return length;
}

TEST(CavePaths, OneLineOfAWayInAndOut) {
  const CavePaths paths = splitPaths({along({{0, 0, 0}, {60, 0, -5}, {60, 1, -5}, {0, 1.2, 0}})}, {});
  ASSERT_EQ(paths.branches.size(), 1U);
  EXPECT_FALSE(paths.branches[0].begins_at || paths.branches[0].ends_at);
  EXPECT_NEAR(lengthOf(paths), 60.2, 1.5);
  // The turning point is the last one.
  EXPECT_NEAR(paths.points[paths.branches[0].last].position.x(), 60.0, 0.6);
}

TEST(CavePaths, KeepsPassagesAbovEachOtherApart) {
  const CavePaths paths = splitPaths({along({{0, 0, 0}, {60, 0, 0}, {60, 0, -6}, {0, 0, -6}})}, {});
  EXPECT_NEAR(lengthOf(paths), 126.0, 2.0);
}

TEST(CavePaths, ClosesALoopInAJunction) {
  // Out along a passage, round a ring, and home.
  const CavePaths paths = splitPaths(
      {along({{0, 0, 0}, {20, 0, 0}, {40, 15, 0}, {60, 0, 0}, {40, -15, 0}, {20, 0, 0}, {0, 0, 0}})}, {});
  ASSERT_EQ(paths.branches.size(), 1U);
  ASSERT_TRUE(paths.branches[0].ends_at);
  EXPECT_LT((paths.points[*paths.branches[0].ends_at].position - Vec3(20, 0, 0)).norm(), 3.0);
}

TEST(CavePaths, BranchesAtAJunctionAndRejoins) {
  const Line main = along({{0, 0, 0}, {100, 0, 0}});
  const Line side = along({{0, 0, 0}, {30, 0, 0}, {50, 20, 0}, {70, 0, 0}, {100, 0, 0}});
  const CavePaths paths = splitPaths({main, side}, {});
  ASSERT_EQ(paths.branches.size(), 2U);
  const CavePathBranch& branch = paths.branches[1];
  ASSERT_TRUE(branch.begins_at && branch.ends_at);
  EXPECT_NEAR(paths.points[*branch.begins_at].position.x(), 31.0, 3.0);
  EXPECT_NEAR(paths.points[*branch.ends_at].position.x(), 69.0, 3.0);
  EXPECT_TRUE(paths.apart.empty());
}

TEST(CavePaths, JoinsADiveThatMeetsNoOther) {
  const CavePaths paths = splitPaths({along({{0, 0, 0}, {50, 0, 0}}), along({{80, 0, 0}, {120, 0, 0}})}, {});
  ASSERT_EQ(paths.branches.size(), 3U);
  EXPECT_THAT(paths.apart, ::testing::ElementsAre(1U));
  EXPECT_TRUE(paths.branches[2].is_connection);
}

TEST(CavePaths, KeepsEveryWayWithoutMerging) {
  CavePathOptions options;
  options.merge_m = 0.0;
  const CavePaths paths = splitPaths({along({{0, 0, 0}, {60, 0, 0}, {0, 0, 0}})}, options);
  EXPECT_NEAR(lengthOf(paths), 120.0, 1.0);
}

TEST(CavePaths, RefusesARigThatDidNotMove) {
  EXPECT_THROW(splitPaths({{Vec3(1, 2, 3)}}, {}), InputError);
  EXPECT_THROW(splitPaths({}, {}), InputError);
}

}  // namespace
}  // namespace lodeline

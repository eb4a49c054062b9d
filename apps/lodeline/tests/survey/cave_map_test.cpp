#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "apps/lodeline/tests/survey/test_cave_map.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"

// Errors of the common solution of three dives against what it claims, for ten draws of all errors.

namespace lodeline {
namespace {

/// Error over sigma of every coordinate of a map's keyframes. Sigmas are at least 1 cm, as in a survey.
std::vector<double> errorsInSigmas(const std::filesystem::path& file, const test::CaveMap& cave) {
  const MapFile map = MapFile::open(file, MapFile::Access::Read);
  std::vector<double> ratios;
  for (const MapDive& dive : map.dives()) {
    map.forEachKeyframe(dive.id, [&](const StoredKeyframe& row) {
      const Vec3 error =
          row.solved->map_from_body.translation - cave.truth.at(row.keyframe.time.nanoseconds());
      const Vec3 sigmas = row.solved->covariance.diagonal().head<3>().cwiseSqrt().cwiseMax(0.01);
      for (int axis = 0; axis < 3; ++axis) ratios.push_back(std::abs(error[axis]) / sigmas[axis]);
    });
  }
  return ratios;
}

TEST(CaveMap, ErrorsOfTenCavesAreThoseThatTheirSolutionsClaim) {
  const test::TemporaryFolder folder;
  double count = 0.0, beyond = 0.0, squares = 0.0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const auto file = folder.path() / fmt::format("{}.db", seed);
    const test::CaveMap cave(file, seed);
    EXPECT_TRUE(cave.unconnected.empty()) << "seed " << seed;
    double worst = 0.0;
    for (const double ratio : errorsInSigmas(file, cave)) {
      ++count;
      squares += ratio * ratio;
      worst = std::max(worst, ratio);
      beyond += ratio > 3.0 ? 1.0 : 0.0;
    }
    EXPECT_LT(worst, 4.0) << "seed " << seed;
  }
  EXPECT_LT(beyond / count, 0.0027);  // the share of a normal distribution
  EXPECT_GT(std::sqrt(squares / count), 0.5);
  EXPECT_LT(std::sqrt(squares / count), 1.0);
}

}  // namespace
}  // namespace lodeline

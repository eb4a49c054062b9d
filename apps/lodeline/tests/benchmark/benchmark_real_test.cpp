#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/lodeline/tests/test_program.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/util/files/test_data.h"

// A test of `lodeline benchmark` on the real excerpt of EuRoC.

namespace lodeline::test {
namespace {

namespace fs = std::filesystem;

TEST(BenchmarkOfEuroc, TheExcerptHasAFigureBesideThePublishedOne) {
  const auto excerpt = testData(kMh01Recording);
  if (!excerpt) GTEST_SKIP() << missingTestData(kMh01Recording);
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "set/machine_hall");
  fs::create_directory_symlink(*excerpt, folder.path() / "set/machine_hall/MH_01_easy");
  const Execution result =
      runProgram(fmt::format("benchmark euroc {} -o {} --set source.duration_s=6",
                             quoted(folder.path() / "set"), quoted(folder.path() / "out")));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const auto item = readJson(folder.path() / "out/results/MH_01_easy.default/item.json");
  EXPECT_LT(item["evaluation"]["position_rmse_m"], 0.05);
  EXPECT_GT(item["evaluation"]["path_m"], 1.0);
  EXPECT_THAT(result.output,
              testing::AllOf(testing::HasSubstr("| MH_01_easy | done |"), testing::HasSubstr("| 0.036 |")));
}

}  // namespace
}  // namespace lodeline::test

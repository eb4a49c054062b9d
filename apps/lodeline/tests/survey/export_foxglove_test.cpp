#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/lodeline/tests/test_program.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/output/survey/formats/test_outside_program.h"
#include "lodeline/util/files/test_data.h"

// Tests of `lodeline export --format mcap` as a program.

namespace lodeline {
namespace {

using test::Execution;
using test::runProgram;
using ::testing::HasSubstr;

class ExportFoxgloveTest : public ::testing::Test {
 protected:
  void SetUp() override {
    writeRun("run", 1795255200);
    folder_.write("run/trajectory_map.tum", test::readText(folder_.path() / "run/trajectory.tum"));
  }
  void writeRun(const std::string& name, int64_t first_s) {
    std::string poses, states =
                           "#timestamp [ns],status,tracks,sigma_p_x [m],field_x [T],cov_pose_00,cov_pose_01,"
                           "cov_pose_02,cov_pose_11,cov_pose_12,cov_pose_22\n";
    for (int i = 0; i <= 200; ++i) {
      poses += fmt::format("{}.5 {:.3f} {:.3f} 0 0 0 0 1\n", first_s + i, 0.1 * i, 0.002 * i * i);
      states += fmt::format("{}500000000,tracking,{},{},nan,1e-4,0,0,1e-4,0,1e-4\n", first_s + i, 90 + i % 7,
                            0.001 * i);
    }
    folder_.write(name + "/trajectory.tum", poses);
    folder_.write(name + "/states.csv", states);
    folder_.write(name + "/run.json", R"({"heading": {"reference": "true north"}, "findings": [
        {"severity": "warning", "kind": "imu_gap", "message": "imu0: nothing for 1 s", "count": 1}]})");
  }
  Execution exportRun(const std::string& arguments) {
    return runProgram("export " + test::quoted(folder_.path() / "run") + " " + arguments);
  }
  std::filesystem::path file(const std::string& name) const { return folder_.path() / "run/export" / name; }

  test::TemporaryFolder folder_;
};

TEST_F(ExportFoxgloveTest, WritesTheFileTwiceAlike) {
  const Execution result = exportRun("--format MCAP");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("run.mcap"));
  const std::string bytes = test::readText(file("run.mcap"));
  EXPECT_GT(bytes.size(), 5000u);
  ASSERT_EQ(exportRun("--format mcap,csv").exit_code, 0);
  EXPECT_TRUE(test::readText(file("run.mcap")) == bytes);
  EXPECT_TRUE(std::filesystem::exists(file("run_poses.csv")));
}

TEST_F(ExportFoxgloveTest, OtherProgramsReadEveryMessageByItsSchema) {
  const std::filesystem::path web = testSourceDir() / "web";
  if (!std::filesystem::exists(web / "node_modules/@mcap/core"))
    GTEST_SKIP() << "web/node_modules has no @mcap/core (npm ci in web/)";
  folder_.write("run/pictures/1795255300500000000.jpg", "a picture");
  ASSERT_EQ(exportRun("--format mcap --images").exit_code, 0);
  const test::OutsideRun check =
      test::runIn(web, "node test/foxglove_check.mjs " + test::quoted(file("run.mcap")));
  EXPECT_EQ(check.exit_code, 0) << check.output;
  EXPECT_EQ(check.output,
            "/odometry foxglove.PoseInFrame 201 1795255200500000000 1795255400500000000\n"
            "/path/map foxglove.PosesInFrame 1 1795255200500000000 1795255200500000000\n"
            "/path/run foxglove.PosesInFrame 1 1795255200500000000 1795255200500000000\n"
            "/pictures foxglove.CompressedImage 1 1795255300500000000 1795255300500000000\n"
            "/states lodeline.State 201 1795255200500000000 1795255400500000000\n"
            "/status foxglove.Log 2 1795255200500000000 1795255200500000000\n"
            "/tf foxglove.FrameTransform 402 1795255200500000000 1795255400500000000\n");
}

TEST_F(ExportFoxgloveTest, SeveralRunsMakeAFileEach) {
  writeRun("other", 1795260000);
  const Execution result = exportRun(test::quoted(folder_.path() / "other") + " --format mcap -o " +
                                     test::quoted(folder_.path() / "maps"));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  for (const char* name : {"maps/run.mcap", "maps/other.mcap"})
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / name)) << name;
}

TEST_F(ExportFoxgloveTest, TellsWhatIsMissingOrWrong) {
  Execution result = exportRun("--format mcap --images");
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("no pictures of the run there"));
  result = exportRun("--format csv --images");
  EXPECT_EQ(result.exit_code, 2) << result.output;
  EXPECT_THAT(result.output, HasSubstr("--images belongs to --format mcap"));
  folder_.write("run/trajectory_map.tum", "1 2 3\n");
  result = exportRun("--format mcap");
  EXPECT_GT(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("trajectory_map.tum:1"));
  std::filesystem::remove(folder_.path() / "run/trajectory.tum");
  result = exportRun("--format mcap");
  EXPECT_GT(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("no trajectory.tum there"));
}

TEST_F(ExportFoxgloveTest, KeepsAFileOfAnotherDive) {
  folder_.write("run/export/run.mcap", "of another dive");
  const Execution result = exportRun("--format mcap");
  EXPECT_EQ(result.exit_code, 2) << result.output;
  EXPECT_THAT(result.output, HasSubstr("is there already"));
  EXPECT_EQ(test::readText(file("run.mcap")), "of another dive");
  EXPECT_EQ(exportRun("--format mcap --overwrite").exit_code, 0);
}

}  // namespace
}  // namespace lodeline

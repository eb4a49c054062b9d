#include "apps/lodeline/tests/test_room.h"
#include "lodeline/output/report/page/page_template.h"

// Tests of `lodeline report`, and of the report that `lodeline run` writes.

namespace lodeline::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class Report : public RoomTest {
 protected:
  void SetUp() override {
    if (pageTemplate().empty()) GTEST_SKIP() << "built without the report page";
  }
};

TEST_F(Report, OfARunHoldsItsPicturesAndNoReference) {
  ASSERT_EQ(run().exit_code, 0);
  const std::string page = readText(output_ / "report.html");
  EXPECT_THAT(page, AllOf(HasSubstr("\"jpeg\":\"/9j/"), HasSubstr("\"evaluation\":null")));
}

TEST_F(Report, CanBeLeftOut) {
  ASSERT_EQ(run("--no-report").exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(output_ / "report.html"));
  EXPECT_FALSE(std::filesystem::exists(output_ / "pictures"));
}

TEST_F(Report, TakesTheGroundTruthThatTheRecordingBringsAlong) {
  const auto truth = recording_.sensor("state_groundtruth_estimate0");
  std::filesystem::create_directories(truth);
  std::filesystem::copy_file(recording_.truth, truth / "gt_tum.txt");
  ASSERT_EQ(run().exit_code, 0);
  EXPECT_THAT(readText(output_ / "report.html"), HasSubstr("\"evaluation\":{\"figures\""));
}

TEST_F(Report, GroundTruthThatCannotBeReadIsARemark) {
  std::filesystem::create_directories(recording_.sensor("state_groundtruth_estimate0"));
  const Execution result = run();
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.output, HasSubstr("without the recording's ground truth"));
  EXPECT_THAT(readText(output_ / "report.html"), HasSubstr("\"evaluation\":null"));
}

TEST_F(Report, ComparesRunsWithAReference) {
  ASSERT_EQ(run("--no-report").exit_code, 0);
  const std::filesystem::path page = folder_.path() / "both.html";
  const Execution result = runProgram(fmt::format("report {0} {0} --reference {1} -o {2}", quoted(output_),
                                                  quoted(recording_.truth), quoted(page)));
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, AllOf(HasSubstr("both.html"), HasSubstr("2 runs")));
  EXPECT_THAT(readText(page), HasSubstr("\"evaluation\":{\"figures\""));
}

TEST_F(Report, WhatIsNoRunIsNamed) {
  const Execution result = runProgram("report " + quoted(folder_.path()));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, HasSubstr("states.csv"));
  EXPECT_EQ(runProgram("report").exit_code, 2);
}

}  // namespace
}  // namespace lodeline::test

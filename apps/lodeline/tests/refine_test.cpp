#include "apps/lodeline/tests/test_room.h"

// Tests of `lodeline refine`: its files, and that it is not less accurate than its run.

namespace lodeline::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class RefineCommandTest : public RoomTest {
 protected:
  Execution refine(const std::string& options = "") const {
    return runProgram(
        fmt::format("refine {} -o {} --no-report {}", quoted(recording_.data), quoted(output_), options));
  }

  double refinedError_m() const {
    return evaluateRun(output_ / "trajectory_refined.tum", recording_.truth,
                       "")["absolute"]["position_m"]["rmse"];
  }

  size_t lines(const char* name) const {
    const std::string text = readText(output_ / name);
    return static_cast<size_t>(std::count(text.begin(), text.end(), '\n'));
  }
};

TEST_F(RefineCommandTest, WritesRefinedFilesBesideThoseOfTheRun) {
  const Execution result = refine();
  expectGoodResult(result);
  EXPECT_THAT(result.output, AllOf(HasSubstr("refinement"), HasSubstr("states"), HasSubstr("cost")));
  EXPECT_EQ(lines("trajectory_refined.tum"), lines("trajectory.tum"));
  EXPECT_EQ(lines("states_refined.csv"), lines("states.csv"));
  EXPECT_THAT(readText(output_ / "landmarks_refined.ply").substr(0, 3), "ply");
  const nlohmann::json refinement = summary()["refinement"];
  EXPECT_EQ(refinement["used"], true);
  EXPECT_LE(refinement["cost"]["first_round"].get<double>(), refinement["cost"]["forward"].get<double>());
  EXPECT_EQ(refinement["has_covariance"], true);
  EXPECT_LT(refinedError_m(), 1.2 * error_m());
}

TEST_F(RefineCommandTest, EveryImageMayBeAState) {
  const Execution result = refine("--state-interval 0");
  expectGoodResult(result);
  EXPECT_EQ(summary()["refinement"]["states"], kRoomImages);
}

TEST_F(RefineCommandTest, ARunOverwritesWhatWasRefined) {
  refine();
  expectGoodResult(run());
  EXPECT_FALSE(std::filesystem::exists(output_ / "trajectory_refined.tum"));
  EXPECT_FALSE(summary().contains("refinement"));
}

TEST_F(RefineCommandTest, RefusesAnIntervalThatIsNone) {
  EXPECT_EQ(refine("--state-interval -1").exit_code, 2);
  EXPECT_EQ(refine("--state-interval x").exit_code, 2);
}

TEST_F(RefineCommandTest, ARunWithoutPosesIsRefinedToNothing) {
  for (size_t i = 0; i < recording_.image_names.size(); ++i) {
    for (int camera = 0; camera < 2; ++camera) writeBlankImage(recording_.image(camera, i));
  }
  const Execution result = refine();
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_EQ(findings("refinement_refused"), 1);
  EXPECT_FALSE(std::filesystem::exists(output_ / "trajectory_refined.tum"));
}

}  // namespace
}  // namespace lodeline::test

#include <algorithm>

#include "apps/lodeline/tests/batch/test_batch.h"

// Tests of `lodeline batch` as a program: what one process makes, records and keeps.

namespace lodeline::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

class BatchRuns : public BatchTest {};

TEST_F(BatchRuns, EvaluatesAndTabulatesAllAndRunsNothingAgain) {
  const Execution first = batch("--jobs 2");
  ASSERT_EQ(first.exit_code, 0) << first.output;
  EXPECT_EQ(made(first.output), kBatchRecordings);
  EXPECT_THAT(names("results"), SizeIs(kBatchRecordings));
  expectNothingLeftOver();
  const nlohmann::json item = readJson(output_ / "results/dive3.default/item.json");
  EXPECT_EQ(item["exit_code"], 0);
  EXPECT_LT(item["evaluation"]["position_rmse_m"], 0.01);
  EXPECT_GT(item["evaluation"]["position_rmse_m"], 0.0);
  const nlohmann::json evaluation =
      evaluateRun(output_ / "results/dive3.default", folder_.path() / "truth.tum", "");
  EXPECT_EQ(item["evaluation"]["position_rmse_m"], evaluation["absolute"]["position_m"]["rmse"]);
  const std::string table = readText(output_ / "table.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), kBatchRecordings + 1);
  EXPECT_THAT(readText(output_ / "table.md"), HasSubstr("| default | 5 | 5 | 0 | 5 |"));

  const auto time = std::filesystem::last_write_time(output_ / "results/dive3.default/run.json");
  const Execution second = batch();
  EXPECT_EQ(second.exit_code, 0);
  EXPECT_EQ(made(second.output), 0);
  EXPECT_THAT(second.output, HasSubstr("made 0, kept 5, failed 0"));
  EXPECT_EQ(std::filesystem::last_write_time(output_ / "results/dive3.default/run.json"), time);
  EXPECT_EQ(readText(output_ / "table.csv"), table);
}

TEST_F(BatchRuns, AChangedRecordingIsRunAgainAlone) {
  ASSERT_EQ(batch("--shard 1/4").exit_code, 0);  // dives 0 and 4
  copyRecording(4);
  editLines(recording(4) / "mav0/imu0/data.csv",
            [](std::vector<std::string>& lines) { lines.emplace_back("# a remark"); });
  EXPECT_THAT(batch("--shard 1/4").output, HasSubstr("made 1, kept 1, failed 0"));
}

TEST_F(BatchRuns, AFailureIsRecordedAndOthersGoOn) {
  copyRecording(4);
  std::filesystem::remove(recording(4) / "mav0/imu0/data.csv");
  const Execution first = batch("--shard 1/4");
  EXPECT_EQ(first.exit_code, 1);
  EXPECT_THAT(first.output, AllOf(HasSubstr("made 1, kept 0, failed 1"), HasSubstr("items failed: 1 of 2")));
  EXPECT_THAT(names("results"), testing::ElementsAre("dive0.default"));
  const nlohmann::json item = readJson(output_ / "failed/dive4.default/item.json");
  EXPECT_EQ(item["exit_code"], 1);
  EXPECT_THAT(item["last_lines"].back().get<std::string>(), AllOf(HasSubstr("bad input"), HasSubstr("imu0")));
  EXPECT_THAT(readText(output_ / "table.csv"), HasSubstr("dive4.default,dive4,default,,failed,1"));
  expectNothingLeftOver();

  const Execution second = batch("--shard 1/4");
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_THAT(second.output, Not(HasSubstr("started")));
  const Execution third = batch("--shard 1/4 --retry");
  EXPECT_EQ(third.exit_code, 1);
  EXPECT_THAT(third.output,
              AllOf(HasSubstr("dive4.default started"), Not(HasSubstr("dive0.default started"))));
  EXPECT_EQ(batch("--summary").exit_code, 1);

  std::filesystem::copy(recording(0) / "mav0/imu0/data.csv", recording(4) / "mav0/imu0/data.csv");
  EXPECT_EQ(batch("--shard 1/4").exit_code, 0);
  EXPECT_THAT(names("failed"), IsEmpty());
  EXPECT_THAT(names("results"), SizeIs(2));
}

TEST_F(BatchRuns, VariantsAreRunWithTheirSettingsAndCompared) {
  writeList("variants:\n  - {name: both}\n  - {name: left, set: {source.cameras: [0]}}\nseeds: [3]\n");
  const Execution first = batch("--shard 1/8");  // dive 0 with both, dive 4 with both
  ASSERT_NE(first.exit_code, 2) << first.output;
  EXPECT_THAT(names("results"), testing::IsSupersetOf({"dive0.both.3", "dive4.both.3"}));
  const Execution left = batch("--shard 2/8");
  ASSERT_NE(left.exit_code, 2) << left.output;
  const std::string kind = names("results").contains("dive0.left.3") ? "results" : "failed";
  EXPECT_THAT(readJson(output_ / kind / "dive0.left.3/item.json")["arguments"],
              testing::IsSupersetOf({"source.cameras=[0]", "front_end.seed=3"}));

  const Execution compared = batch("--summary --against " + quoted(output_));
  EXPECT_THAT(compared.output, HasSubstr("Comparison with the other batch"));
  EXPECT_THAT(compared.output, HasSubstr("| both | 2 |"));
}

TEST_F(BatchRuns, ASimulatedRecordingIsMadeOnceForAllVariants) {
  folder_.write("list.yaml",
                "recordings:\n  - {simulate: figure_eight --seconds 30, name: eight}\n"
                "variants: [{name: a}, {name: b}]\nseeds: [1, 2]\n");
  const Execution result = batch("--jobs 4");
  EXPECT_EQ(result.exit_code, 1) << "a recording without images has no trajectory";
  EXPECT_THAT(names("recordings"), testing::ElementsAre("eight.1", "eight.2"));
  EXPECT_THAT(names("failed"), testing::ElementsAre("eight.a.1", "eight.a.2", "eight.b.1", "eight.b.2"));
  EXPECT_NE(readText(output_ / "recordings/eight.1/mav0/imu0/data.csv"),
            readText(output_ / "recordings/eight.2/mav0/imu0/data.csv"));
  EXPECT_EQ(readJson(output_ / "failed/eight.b.2/item.json")["stage"], "run");
  expectNothingLeftOver();
}

TEST_F(BatchRuns, AWrongListIsNamedWithItsLine) {
  const auto expectRefused = [&](const std::string& text, const std::string& line, const char* says) {
    folder_.write("list.yaml", text);
    const Execution result = batch();
    EXPECT_EQ(result.exit_code, 2) << text;
    EXPECT_THAT(result.output, AllOf(HasSubstr("list.yaml:" + line + ": "), HasSubstr(says))) << text;
    EXPECT_FALSE(std::filesystem::exists(output_)) << text;
  };
  const std::string one = "recordings:\n  - dive0\n";
  expectRefused("variants: []\n", "1", "recordings");
  expectRefused("recordings: [dive0\nseeds: [1]\n", "2", "not valid YAML");
  expectRefused(one + "  - {data: dive9}\n", "3", "dive9 does not exist");
  expectRefused(one + "  - {data: dive1, trut: truth.tum}\n", "3", "did you mean 'truth'?");
  expectRefused(one + "  - {data: dive1, truth: none.tum}\n", "3", "none.tum does not exist");
  expectRefused(one + "  - dive0\n", "3", "used twice");
  expectRefused(one + "  - {name: x}\n", "3", "`data` and `simulate`");
  expectRefused(one + "variants:\n  - {set: {}}\n", "4", "`name`");
  expectRefused(one + "variants:\n  - {name: a/b}\n", "4", "letters");
  expectRefused(one + "variants:\n  - name: a\n    set: {front_end.seeds: 1}\n", "5", "front_end.seed");
  expectRefused(one + "seeds: [1, two]\n", "3", "whole number");
  expectRefused(one + "align: sideways\n", "3", "sim3");
  expectRefused(one + "tolerance_s: 2\n", "3", "at most 1");
  expectRefused(one + "jobs: 3\n", "3", "unknown key 'jobs'");
}

TEST_F(BatchRuns, WrongUsageEndsWithTwo) {
  EXPECT_EQ(batch("--shard 0/2").exit_code, 2);
  EXPECT_EQ(batch("--shard 3/2").exit_code, 2);
  EXPECT_EQ(batch("--shard 1").exit_code, 2);
  EXPECT_EQ(batch("--shard 1/2x").exit_code, 2);
  EXPECT_EQ(batch("--jobs 0").exit_code, 2);
  EXPECT_EQ(batch("--against /nowhere").exit_code, 2);
  EXPECT_EQ(runProgram("batch none.yaml -o x").exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(output_));
}

}  // namespace
}  // namespace lodeline::test

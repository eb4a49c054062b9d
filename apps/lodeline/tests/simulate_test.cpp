#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/lodeline/tests/test_program.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"

// Tests of `lodeline simulate` as a program.

namespace lodeline {
namespace {

using test::Execution;
using test::runProgram;
using ::testing::HasSubstr;

class SimulateTest : public ::testing::Test {
 protected:
  std::string file(const std::string& name) const { return test::quoted(folder_.path() / name); }

  test::TemporaryFolder folder_;
};

TEST_F(SimulateTest, WritesARecordingThatEvaluatesAgainstItself) {
  const Execution result = runProgram("simulate figure_eight --seconds 30 -o " + file("a"));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("figure_eight: 30.0 s"));
  const std::filesystem::path truth =
      folder_.path() / "a" / "mav0" / "state_groundtruth_estimate0" / "data.csv";
  const Execution evaluation = runProgram("evaluate " + test::quoted(truth) + " " + test::quoted(truth));
  EXPECT_EQ(evaluation.exit_code, 0) << evaluation.output;
}

TEST_F(SimulateTest, ReplacesAnotherRecordingOnlyWhenTold) {
  const std::string command = "simulate figure_eight --seconds 10 --no-images -q -o " + file("a");
  const std::filesystem::path imu = folder_.path() / "a" / "mav0" / "imu0" / "data.csv";
  ASSERT_EQ(runProgram(command).exit_code, 0);
  const std::string first = test::readText(imu);
  EXPECT_EQ(runProgram(command + " --seed 7").exit_code, 1);
  EXPECT_TRUE(test::readText(imu) == first);
  EXPECT_EQ(runProgram(command + " --seed 7 --overwrite").exit_code, 0);
  EXPECT_FALSE(test::readText(imu) == first);
  // Nothing but a recording of the simulator is removed.
  std::filesystem::remove(folder_.path() / "a" / "truth" / "scenario.yaml");
  EXPECT_EQ(runProgram(command + " --overwrite").exit_code, 1);
  EXPECT_TRUE(std::filesystem::exists(imu));
}

TEST_F(SimulateTest, SaysWhatItCanSimulate) {
  const Execution help = runProgram("simulate --help");
  EXPECT_EQ(help.exit_code, 0);
  for (const char* name :
       {"cave1_short", "cave1_long", "dos_ojos", "demo", "figure_eight", "bench", "open_water"}) {
    EXPECT_THAT(help.output, HasSubstr(name));
  }
  const Execution effects = runProgram("simulate --list-effects");
  EXPECT_EQ(effects.exit_code, 0);
  EXPECT_THAT(effects.output, HasSubstr("flat_port"));
}

TEST_F(SimulateTest, EndsWithTwoOnWrongUsageAndWritesNothing) {
  const auto expectUsageError = [&](const std::string& arguments, const char* says) {
    const Execution result = runProgram("simulate " + arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments;
    EXPECT_THAT(result.output, HasSubstr(says)) << arguments;
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "x")) << arguments;
  };
  expectUsageError("-o " + file("x"), "name a scenario");
  expectUsageError("demo", "-o");
  expectUsageError("cave9 -o " + file("x"), "cave1_short");
  expectUsageError("demo -o " + file("x") + " --realism dirty", "clean, field and physical");
  expectUsageError("demo -o " + file("x") + " --effect fog=on", "silt_outs");
  expectUsageError("demo --seconds 20 --metres 500 -o " + file("x"), "m/s");
  expectUsageError("demo --width many -o " + file("x"), "--width");
}

TEST_F(SimulateTest, RefusesAFolderInUseAndOneThatCannotBeWritten) {
  folder_.write("notes.txt", "mine");
  const Execution used = runProgram("simulate bench --seconds 5 -o " + test::quoted(folder_.path()));
  EXPECT_EQ(used.exit_code, 1);
  EXPECT_THAT(used.output, HasSubstr("choose another folder"));
  const Execution nowhere = runProgram("simulate bench --seconds 5 -o /proc/nowhere");
  EXPECT_EQ(nowhere.exit_code, 1);
  EXPECT_THAT(nowhere.output, HasSubstr("cannot be written"));
}

}  // namespace
}  // namespace lodeline

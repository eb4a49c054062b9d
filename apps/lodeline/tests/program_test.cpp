#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/lodeline/tests/test_program.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"

// Tests of the program's exit codes and printed output.

namespace lodeline {
namespace {

using test::Execution;
using test::runProgram;
using ::testing::HasSubstr;

class ProgramTest : public ::testing::Test {
 protected:
  /// Path of a file of the test, quoted for the shell.
  std::string file(const std::string& name) const {
    return fmt::format("'{}'", (folder_.path() / name).string());
  }

  test::TemporaryFolder folder_;
  const std::string tum_ =
      "# timestamp [s] x y z qx qy qz qw\n"
      "1.0 0 0 0 0 0 0 1\n2.0 1 0 0 0 0 0 1\n3.0 1 1 0 0 0 0 1\n4.0 0 1 1 0 0 0 1\n";
};

TEST_F(ProgramTest, PrintsVersionAndHelp) {
  const Execution version = runProgram("--version");
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_THAT(version.output,
              ::testing::ContainsRegex("^lodeline [0-9]+\\.[0-9]+\\.[0-9]+ \\(commit "
                                       "(unknown|[0-9a-f]{12,40}(-dirty)?), [A-Za-z]+\\)\n$"));
  EXPECT_EQ(runProgram("--help").exit_code, 0);
  const Execution help = runProgram("evaluate --help");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.output, HasSubstr("Examples:"));
}

TEST_F(ProgramTest, ExplainsACommandInThreeWays) {
  EXPECT_EQ(runProgram("help").output, runProgram("--help").output);
  EXPECT_EQ(runProgram("help").exit_code, 0);
  const Execution help = runProgram("help calibrate magnetometer");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_EQ(help.output, runProgram("calibrate magnetometer --help").output);
  const Execution unknown = runProgram("help evalute");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.output, HasSubstr("evaluate"));
}

TEST_F(ProgramTest, EndsWithTwoOnWrongUsage) {
  folder_.write("a.tum", tum_);
  EXPECT_EQ(runProgram("").exit_code, 2);
  EXPECT_EQ(runProgram("evaluate").exit_code, 2);
  EXPECT_EQ(runProgram("unknown-command").exit_code, 2);
  EXPECT_EQ(runProgram("evaluate " + file("a.tum") + " " + file("a.tum") + " --unknown").exit_code, 2);
  EXPECT_EQ(runProgram("evaluate " + file("a.tum") + " " + file("a.tum") + " --align sim4").exit_code, 2);
  EXPECT_EQ(runProgram("evaluate " + file("a.tum") + " " + file("a.tum") + " --format odd").exit_code, 2);
  EXPECT_EQ(
      runProgram("evaluate " + file("a.tum") + " " + file("a.tum") + " --time-tolerance-s -1").exit_code, 2);
  EXPECT_EQ(runProgram("evaluate " + file("a.tum") + " " + file("a.tum") + " --stretches-m 0").exit_code, 2);
}

TEST_F(ProgramTest, RefusesColmapOptionsWithoutAColmapModel) {
  folder_.write("a.tum", tum_);
  folder_.write("times.txt", "a.png 1.0\n");
  const Execution result =
      runProgram("evaluate " + file("a.tum") + " " + file("a.tum") + " --image-times " + file("times.txt"));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("COLMAP"));
}

TEST_F(ProgramTest, EvaluatesARunWhoseClaimsCannotBeRead) {
  folder_.write("a.tum", tum_);
  std::filesystem::create_directories(folder_.path() / "run");
  folder_.write("run/trajectory.tum", tum_);
  folder_.write("run/states.csv", "#timestamp [ns],status\n1000000000,tracking\n");
  const Execution result = runProgram("evaluate " + file("run") + " " + file("a.tum"));
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("not compared with claimed sigmas"));
}

TEST_F(ProgramTest, EndsWithOneOnBadInputAndSaysWhere) {
  folder_.write("a.tum", tum_);
  folder_.write("bad.tum", "1.0 0 0 0 0 0 0 1\n2.0 0 x 0 0 0 0 1\n");
  const Execution missing = runProgram("evaluate " + file("absent.tum") + " " + file("a.tum"));
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.output, HasSubstr("absent.tum"));
  const Execution damaged = runProgram("evaluate " + file("bad.tum") + " " + file("a.tum"));
  EXPECT_EQ(damaged.exit_code, 1);
  EXPECT_THAT(damaged.output, HasSubstr("bad.tum:2"));
}

TEST_F(ProgramTest, EndsWithOneOnUnwritableOutput) {
  folder_.write("a.tum", tum_);
  const std::string both = file("a.tum") + " " + file("a.tum");
  EXPECT_EQ(runProgram("evaluate " + both + " --json " + file("absent/figures.json")).exit_code, 1);
  EXPECT_EQ(runProgram("evaluate " + both + " --plots " + file("a.tum")).exit_code, 1);
}

TEST_F(ProgramTest, EvaluatesAndWritesTheFigures) {
  folder_.write("run/trajectory.tum", tum_);
  folder_.write("truth.tum", tum_);
  folder_.write("cam0/data.csv", "#timestamp [ns],filename\n2000000000,a.png\n5000000000,b.png\n");
  const Execution result = runProgram("evaluate " + file("run") + " " + file("truth.tum") + " --images " +
                                      file("cam0") + " --json " + file("figures.json"));
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("50.00 % (1 of 2 images)"));
  std::ifstream stream(folder_.path() / "figures.json");
  const auto json = nlohmann::json::parse(stream);
  EXPECT_EQ(json["association"]["pairs"], 4);
  EXPECT_LT(json["absolute"]["position_m"]["max"].get<double>(), 1e-9);
}

}  // namespace
}  // namespace lodeline

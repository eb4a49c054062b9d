#include <cstdlib>
#include <fstream>

#include "apps/lodeline/tests/test_room.h"
#include "lodeline/output/walls/fusion/tile_fusion.h"

// Tests that commands show per cent and remaining time. LODELINE_PROGRESS_S=0 prints each state of the
// progress, which a terminal shows after two seconds.

namespace lodeline::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::Not;

constexpr const char* kPause = "LODELINE_PROGRESS_S";

class ProgressTest : public RoomTest {
 protected:
  ProgressTest() { setenv(kPause, "0", 1); }
  ~ProgressTest() override { unsetenv(kPause); }

  std::string file(const std::string& name) const { return quoted(folder_.path() / name); }

  /// Expects lines of a task with per cent and remaining time.
  static void expectTasks(const std::string& output, const std::vector<std::string>& tasks) {
    for (const std::string& task : tasks)
      EXPECT_THAT(output, ContainsRegex(task + " +[0-9]+ %  [0-9:]+ left"));
  }
  static void expectProgress(const std::string& arguments, const std::vector<std::string>& tasks) {
    const Execution result = runProgram(arguments);
    EXPECT_EQ(result.exit_code, 0) << arguments << "\n" << result.output;
    expectTasks(result.output, tasks);
  }
  void simulate(const std::string& name, const std::string& options) const {
    expectProgress("simulate " + options + " --quiet -o " + file(name), {});
  }
};

TEST_F(ProgressTest, OfWorkOnARecording) {
  const std::string data = quoted(recording_.data), out = quoted(output_);
  expectProgress("inspect " + data, {"inspection"});
  expectProgress("convert " + data + " " + file("copy"), {"conversion"});
  expectProgress("attitude " + data + " -o " + file("attitude"), {"reading"});
  expectProgress("refine " + data + " -o " + out + " --no-report", {"run", "refinement"});
  const std::string truth = quoted(recording_.truth);
  expectProgress(
      "evaluate " + out + " " + truth + " --plots " + file("plots") + " --html " + file("page.html"),
      {"evaluation", "plots", "page"});
  expectProgress("report " + out + " -o " + file("report.html"), {"page"});
  expectProgress("export " + out + " --format csv,ply -o " + file("export"), {"files"});
  if (hasOpen3d())
    expectProgress("walls " + out + " -o " + file("walls") + " --step 0.04 --voxel 0.04",
                   {"depths", "files"});
}

TEST_F(ProgressTest, OfMaps) {
  ASSERT_EQ(run("--no-report --quiet").exit_code, 0);
  const std::string map = file("cave.db");
  expectProgress("map build " + map + " " + quoted(output_), {"joining dives", "solving"});
  expectProgress("map solve " + map, {"solving"});
  folder_.write("cave.yaml", "dives:\n  - {run: " + output_.string() + "}\n");
  expectProgress("survey " + file("cave.yaml") + " -o " + file("survey"), {"joining dives", "solving"});
  expectProgress("map export " + map + " --format csv,ply -o " + file("files"), {"files"});
}

TEST_F(ProgressTest, OfManyRuns) {
  folder_.write("list.yaml", fmt::format("args: [--no-report]\nrecordings:\n  - {{name: one, data: {0}}}\n"
                                         "  - {{name: two, data: {0}}}\n",
                                         recording_.data.string()));
  expectProgress("batch " + file("list.yaml") + " -o " + file("batch"), {"batch"});
}

TEST_F(ProgressTest, OfCalibrations) {
  simulate("bench", "bench --seconds 30");
  expectProgress("allan " + file("bench"), {"reading"});
  simulate("eight", "figure_eight");
  expectProgress("calibrate magnetometer " + file("eight"), {"reading"});
  simulate("ramps", "current_ramps");
  expectProgress("calibrate magnetometer " + file("ramps") + " --currents", {"reading"});
}

TEST_F(ProgressTest, OfCameraCalibrationAndRendering) {
  const std::string board = file("board");
  expectProgress("simulate board --seconds 7 --camera-rate-hz 4 --width 320 -o " + board, {"rendering"});
  const Execution result = runProgram("calibrate cameras " + board + " -o " + file("rig"));
  EXPECT_TRUE(result.exit_code == 0 || result.exit_code == 3)
      << result.output;  // its quality does not matter
  expectTasks(result.output, {"searching for the board", "solving"});
}

TEST_F(ProgressTest, IsSilentOnRequest) {
  const Execution quiet = runProgram("inspect --quiet " + quoted(recording_.data));
  EXPECT_EQ(quiet.exit_code, 0);
  EXPECT_THAT(quiet.output, Not(ContainsRegex("[0-9]+ %  [0-9:]+ left")));
}

TEST_F(ProgressTest, RefusesAPauseThatIsNoNumber) {
  for (const char* pause : {"soon", "-1", "nan", ""}) {
    setenv(kPause, pause, 1);
    const Execution result = runProgram("inspect " + quoted(recording_.data));
    EXPECT_EQ(result.exit_code, 2) << pause;
    EXPECT_THAT(result.output, ContainsRegex("LODELINE_PROGRESS_S=")) << pause;
  }
}

}  // namespace
}  // namespace lodeline::test

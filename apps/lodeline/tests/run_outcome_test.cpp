#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include "apps/lodeline/tests/test_room.h"
#include "lodeline/output/report/page/page_template.h"

// Tests of `lodeline run`: input search, output, and exit.

namespace lodeline::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

using RunOutcome = RoomTest;

std::vector<std::string> writtenFiles() {
  std::vector<std::string> files = {"config.yaml",   "trajectory.tum",     "states.csv",
                                    "landmarks.ply", "run.json",           "map.db",
                                    "loops.csv",     "trajectory_map.tum", "keyframes_map.tum"};
  if (!pageTemplate().empty()) files.push_back("report.html");
  return files;
}

TEST_F(RunOutcome, MissingDataIsNamed) {
  std::filesystem::rename(recording_.data, folder_.path() / "elsewhere");
  const Execution result = run();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, AllOf(HasSubstr(recording_.data.string()), HasSubstr("mav0")));
  EXPECT_FALSE(std::filesystem::exists(output_));
}

TEST_F(RunOutcome, FolderWithoutRecordingIsNamed) {
  std::filesystem::remove_all(recording_.data / "mav0");
  const Execution result = run();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, AllOf(HasSubstr(recording_.data.string()), HasSubstr("mav0")));
}

TEST_F(RunOutcome, ABadFileOfTagsIsNamedBeforeAnythingIsWritten) {
  const std::filesystem::path tags = folder_.path() / "tags.csv";
  std::ofstream(tags) << "name,tag\nnear,3\n";
  const Execution result = run("--set tags.control=" + tags.string());
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("no size of a tag is known"));
  EXPECT_FALSE(std::filesystem::exists(output_));
}

TEST_F(RunOutcome, PlaysTheRecordingAtTheRateAskedFor) {
  ASSERT_EQ(run("--no-report").exit_code, 0);
  const std::string trajectory = readText(output_ / "trajectory.tum");
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(run("--no-report --rate 0.5").exit_code, 0);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  const double length_s =
      1e-9 * static_cast<double>(roomImageStamp_ns(kRoomImages - 1) - roomImageStamp_ns(0));
  EXPECT_GE(wall.count(), length_s / 0.5);
  EXPECT_EQ(readText(output_ / "trajectory.tum"), trajectory);
}

TEST_F(RunOutcome, TakesMav0ItselfToo) {
  ASSERT_EQ(run().exit_code, 0);
  const std::string trajectory = readText(output_ / "trajectory.tum");
  recording_.data /= "mav0";
  ASSERT_EQ(run().exit_code, 0);
  EXPECT_EQ(readText(output_ / "trajectory.tum"), trajectory);
}

TEST_F(RunOutcome, WrongUsageEndsWithTwo) {
  EXPECT_EQ(runProgram("run").exit_code, 2);
  EXPECT_EQ(runProgram("run " + quoted(recording_.data)).exit_code, 2);
  EXPECT_EQ(run("--unknown").exit_code, 2);
}

TEST_F(RunOutcome, FolderThatCannotBeMadeIsNamed) {
  output_ = folder_.write("file", "") / "out";
  const Execution result = run();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, AllOf(HasSubstr(output_.string()), HasSubstr("-o")));
}

TEST_F(RunOutcome, FilesThatCannotBeWrittenAreNamed) {
  for (const std::string& file : writtenFiles()) {
    std::filesystem::create_directories(output_ / file);
    const Execution result = run();
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.output, HasSubstr((output_ / file).string()));
    std::filesystem::remove_all(output_);
  }
}

TEST_F(RunOutcome, FullDiskIsNoticed) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  for (const std::string& file : writtenFiles()) {
    std::filesystem::create_directories(output_);
    std::filesystem::create_symlink("/dev/full", output_ / file);
    const Execution result = run();
    EXPECT_EQ(result.exit_code, 1) << file;
    const std::string reason = file == "map.db" ? "no regular file" : "disk full";
    EXPECT_THAT(result.output, AllOf(HasSubstr(output_.string()), HasSubstr(reason)));
    std::filesystem::remove_all(output_);
  }
}

TEST_F(RunOutcome, WritesTheWholeFolderAndNothingElse) {
  ASSERT_EQ(run().exit_code, 0);
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(output_)) {
    names.push_back(entry.path().filename().string());
  }
  std::vector<std::string> expected = writtenFiles();
  expected.push_back("timings.csv");
  if (!pageTemplate().empty()) expected.push_back("pictures");
  EXPECT_THAT(names, testing::UnorderedElementsAreArray(expected));
  const nlohmann::json json = summary();
  EXPECT_EQ(json["data"], recording_.data.string());
  EXPECT_GT(json["peak_memory_MB"], 1.0);
  EXPECT_GT(json["landmarks"], 50);
}

TEST_F(RunOutcome, QuietSaysNothing) { EXPECT_EQ(run("--quiet").output, ""); }

/// Extends the recording by half a minute, with the same images forwards and backwards.
void prolong(const RoomRecording& recording) {
  for (const char* camera : {"cam0", "cam1"}) {
    std::ofstream list(recording.csv(camera), std::ios::app);
    for (int i = kRoomImages; i < 20 * kRoomImages; ++i) {
      const int phase = i % (2 * kRoomImages);
      const int image = phase < kRoomImages ? phase : 2 * kRoomImages - 1 - phase;
      list << roomImageStamp_ns(i) << "," << recording.image_names[static_cast<size_t>(image)] << "\n";
    }
  }
  std::ofstream list(recording.csv("imu0"), std::ios::app);
  const int64_t end_ns = roomImageStamp_ns(20 * kRoomImages);
  for (int64_t stamp_ns = roomImageStamp_ns(kRoomImages); stamp_ns < end_ns; stamp_ns += 5'000'000) {
    list << stamp_ns << ",0,0,0,0,0,9.8\n";
  }
}

/// Starts the program, waits until it has written `poses` poses, and sends it the signal.
int signalAfterPoses(const RoomRecording& recording, const std::filesystem::path& output, int poses,
                     int signal) {
  const std::filesystem::path program = programPath();
  const pid_t child = fork();
  if (child == 0) {
    execl(program.c_str(), program.c_str(), "run", recording.data.c_str(), "-o", output.c_str(), "-q",
          nullptr);
    _exit(127);
  }
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (std::chrono::steady_clock::now() < deadline) {
    const std::string text = readText(output / "trajectory.tum");
    if (std::count(text.begin(), text.end(), '\n') > poses) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  kill(child, signal);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_F(RunOutcome, InterruptCompletesTheResultsSoFar) {
  prolong(recording_);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    EXPECT_EQ(signalAfterPoses(recording_, output_, 10, signal), 130);
    const nlohmann::json json = summary();
    EXPECT_TRUE(json["interrupted"]);
    EXPECT_GE(json["frames"], 10);
    EXPECT_LT(json["frames"], 20 * kRoomImages);
    EXPECT_EQ(poses(), json["frames_with_pose"]);
    EXPECT_GT(json["landmarks"], 50);
    const std::string ply = readText(output_ / "landmarks.ply");
    EXPECT_NE(ply.find(fmt::format("element vertex {:012}\n", json["landmarks"].get<int>())),
              std::string::npos);
    std::filesystem::remove_all(output_);
  }
}

TEST_F(RunOutcome, AKilledRunCanBeShownAndExported) {
  prolong(recording_);
  EXPECT_EQ(signalAfterPoses(recording_, output_, 10, SIGKILL), -1);
  const Execution exported = runProgram(
      fmt::format("export {} --format csv --turn 0 -o {}", quoted(output_), quoted(folder_.path() / "map")));
  EXPECT_EQ(exported.exit_code, 0) << exported.output;
  EXPECT_THAT(exported.output, HasSubstr("run.json"));
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "map/out_poses.csv"));
  if (pageTemplate().empty()) return;
  const std::filesystem::path page = folder_.path() / "page.html";
  const Execution reported = runProgram(fmt::format("report {} -o {}", quoted(output_), quoted(page)));
  EXPECT_EQ(reported.exit_code, 0) << reported.output;
  EXPECT_GT(std::filesystem::file_size(page), 100'000u);
}

TEST_F(RunOutcome, AnotherRunIsReplacedOnRequestOnly) {
  ASSERT_EQ(run().exit_code, 0);
  const std::string trajectory = readText(output_ / "trajectory.tum");
  const std::string again =
      fmt::format("{} -o {} --set source.duration_s=0.5", quoted(recording_.data), quoted(output_));
  for (const char* command : {"run ", "refine "}) {
    const Execution refused = runProgram(command + again);
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.output, AllOf(HasSubstr(output_.string()), HasSubstr("--overwrite")));
    EXPECT_EQ(readText(output_ / "trajectory.tum"), trajectory);
  }
  EXPECT_EQ(runProgram("run " + again + " --overwrite").exit_code, 0);
  EXPECT_LT(readText(output_ / "trajectory.tum").size(), trajectory.size());
}

TEST_F(RunOutcome, TheRecordingIsNoFolderForResults) {
  output_ = recording_.data;
  const Execution result = run();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("holds a recording"));
  EXPECT_FALSE(std::filesystem::exists(recording_.data / "run.json"));
}

TEST_F(RunOutcome, ABadByteCostsItsRowAlone) {
  editLines(recording_.csv("imu0"),
            [](std::vector<std::string>& lines) { lines[150] = "14036365\xf8,1,2,3,4,5,6"; });
  expectGoodResult(run());
  EXPECT_EQ(findings("csv_row"), 1);
  EXPECT_THAT(readText(output_ / "run.json"), HasSubstr("data.csv:151"));
}

TEST_F(RunOutcome, MisspeltWordsAreRecognized) {
  const std::string rest = quoted(recording_.data) + " -o " + quoted(output_);
  const auto output = [](const std::string& arguments) {
    const Execution result = runProgram(arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments;
    return result.output;
  };
  EXPECT_THAT(output("runn " + rest), HasSubstr("did you mean 'run'?"));
  EXPECT_THAT(output("run " + rest + " --draw-track 3"), HasSubstr("did you mean '--draw-tracks'?"));
  EXPECT_THAT(output("run " + quoted(recording_.data) + " --output-dir out"),
              HasSubstr("did you mean '--output'?"));
  EXPECT_EQ(
      runProgram("run " + rest + " --site 20.32 -87.39 5 --date 2026-11-21 --magnetometer OFF").exit_code, 0);
}

}  // namespace
}  // namespace lodeline::test

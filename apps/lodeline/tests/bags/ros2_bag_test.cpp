#include <array>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "apps/lodeline/tests/test_room.h"
#include "lodeline/util/files/test_data.h"

// Tests of `lodeline run`, `convert` and `inspect` with bags of ROS 2.

namespace lodeline::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class Ros2BagTest : public RoomTest {
 protected:
  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }

  void convert(const std::filesystem::path& from, const std::string& to,
               const std::string& options = "") const {
    const Execution result =
        runProgram(fmt::format("convert {} {} {}", quoted(from), quoted(path(to)), options));
    ASSERT_EQ(result.exit_code, 0) << result.output;
    EXPECT_EQ(result.output.find("warning"), std::string::npos) << result.output;
  }

  std::string trajectory(const std::filesystem::path& recording) const {
    const std::filesystem::path output = path("out_" + recording.filename().string());
    const Execution result =
        runProgram(fmt::format("run {} -o {} -q --no-report", quoted(recording), quoted(output)));
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return readText(output / "trajectory.tum") + readText(output / "states.csv");
  }

  /// The topics that packages of other authors find in an MCAP file; empty where they are not installed.
  static std::string foreignList(const std::filesystem::path& file) {
    const std::filesystem::path web = testSourceDir() / "web";
    if (!std::filesystem::exists(web / "node_modules/@mcap/core")) return {};
    const std::string command =
        fmt::format("node {} list {} 2>&1", quoted(web / "test/ros2_check.mjs"), quoted(file));
    FILE* pipe = popen(command.c_str(), "r");
    if (pipe == nullptr) return {};
    std::string output;
    std::array<char, 4096> buffer{};
    while (std::fgets(buffer.data(), static_cast<int>(buffer.size()), pipe) != nullptr)
      output += buffer.data();
    return pclose(pipe) == 0 ? output : "failed: " + output;
  }
};

TEST_F(Ros2BagTest, EveryFormatGivesTheSameTrajectory) {
  const std::string expected = trajectory(recording_.data);
  EXPECT_GT(expected.size(), 1000u);
  convert(recording_.data, "none.mcap", "--compression none");
  convert(recording_.data, "lz4.mcap", "--compression lz4");
  convert(recording_.data, "zstd.mcap");
  convert(recording_.data, "database.db3");
  convert(path("zstd.mcap"), "folder_ros2", "--format db3");
  convert(path("folder_ros2"), "folder_mcap", "--format mcap");
  for (const char* name :
       {"none.mcap", "lz4.mcap", "zstd.mcap", "database.db3", "folder_ros2", "folder_mcap"}) {
    EXPECT_TRUE(trajectory(path(name)) == expected) << name;
  }
}

TEST_F(Ros2BagTest, ConvertsThroughAllFormatsWithoutLoss) {
  convert(recording_.data, "first.mcap");
  convert(path("first.mcap"), "second.db3");
  const Execution to_ros1 =
      runProgram(fmt::format("convert {} {}", quoted(path("second.db3")), quoted(path("third.bag"))));
  if (to_ros1.exit_code == 2) GTEST_SKIP() << to_ros1.output;
  ASSERT_EQ(to_ros1.exit_code, 0) << to_ros1.output;
  convert(path("third.bag"), "fourth.mcap", "--compression lz4");
  convert(path("fourth.mcap"), "direct");
  convert(path("first.mcap"), "expected");
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path("expected"))) {
    if (!entry.is_regular_file()) continue;
    const std::filesystem::path below = std::filesystem::relative(entry.path(), path("expected"));
    if (below.extension() == ".yaml") continue;
    EXPECT_TRUE(readText(path("direct") / below) == readText(entry.path())) << below;
  }
}

TEST_F(Ros2BagTest, OtherProgramsReadWhatConvertWrites) {
  std::string first;
  for (const char* compression : {"none", "lz4", "zstd"}) {
    const std::string name = fmt::format("{}.mcap", compression);
    convert(recording_.data, name, fmt::format("--compression {}", compression));
    const std::string list = foreignList(path(name));
    if (list.empty()) GTEST_SKIP() << "web/node_modules has no @mcap/core (npm ci in web/)";
    EXPECT_THAT(list, AllOf(HasSubstr("/cam0/image_raw sensor_msgs/msg/Image 31 "),
                            HasSubstr("/imu0 sensor_msgs/msg/Imu 401 ")));
    if (first.empty()) first = list;
    EXPECT_EQ(list, first) << compression;
  }
}

TEST_F(Ros2BagTest, ATruncatedMcapIsUsedUpToThere) {
  convert(recording_.data, "cut.mcap", "--compression none");
  std::filesystem::resize_file(path("cut.mcap"), std::filesystem::file_size(path("cut.mcap")) * 7 / 10);
  const Execution result = runProgram(fmt::format("run {} -o {}", quoted(path("cut.mcap")), quoted(output_)));
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(findings("bag_truncated"), 1);
  EXPECT_GT(poses(), 15);
}

TEST_F(Ros2BagTest, InspectListsTopicsAndMessages) {
  convert(recording_.data, "listed.mcap");
  const Execution topics = runProgram(fmt::format("inspect {}", quoted(path("listed.mcap"))));
  EXPECT_EQ(topics.exit_code, 0) << topics.output;
  EXPECT_THAT(topics.output, AllOf(HasSubstr("/imu0"), HasSubstr("for imu0"), HasSubstr("for cameras")));
  const Execution messages = runProgram(fmt::format("inspect {} --messages 3", quoted(path("listed.mcap"))));
  EXPECT_EQ(messages.exit_code, 0) << messages.output;
  EXPECT_THAT(messages.output,
              AllOf(HasSubstr("/imu0 sensor_msgs/Imu {header: {stamp: {sec: "),
                    HasSubstr("encoding: \"mono8\", is_bigendian: 0, step: "), HasSubstr(" elements)]}")));
}

TEST_F(Ros2BagTest, RefusesACompressionThatTheFormatDoesNotHave) {
  for (const char* wrong : {"a.mcap bz2", "a.db3 zstd", "a.bag zstd"}) {
    const std::string text(wrong);
    const size_t space = text.find(' ');
    EXPECT_EQ(runProgram(fmt::format("convert {} {} --compression {}", quoted(recording_.data),
                                     quoted(path(text.substr(0, space))), text.substr(space + 1)))
                  .exit_code,
              2)
        << wrong;
  }
}

}  // namespace
}  // namespace lodeline::test

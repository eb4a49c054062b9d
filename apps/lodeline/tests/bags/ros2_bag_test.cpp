#include <fmt/ranges.h>

#include <array>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "apps/lodeline/tests/test_room.h"
#include "lodeline/output/survey/formats/test_outside_program.h"
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

  /// A stamp and six readings, with all digits.
  static std::string imuRow(int64_t time_ns, const std::array<double, 6>& values) {
    return fmt::format("{} {}", time_ns, fmt::join(values, " "));
  }

  std::vector<std::string> recordedImuRows() const {
    std::vector<std::string> rows;
    std::istringstream lines(readText(recording_.csv("imu0")));
    std::string line;
    std::getline(lines, line);  // names of the columns
    while (std::getline(lines, line)) {
      std::replace(line.begin(), line.end(), ',', ' ');
      std::istringstream fields(line);
      int64_t time_ns = 0;
      std::array<double, 6> values{};
      fields >> time_ns;
      for (double& value : values) fields >> value;
      rows.push_back(imuRow(time_ns, values));
    }
    return rows;
  }

  /// What packages of other authors read in an MCAP file: `what` is `list` or `values`.
  std::string foreign(const std::string& what, const std::string& name) const {
    const OutsideRun check =
        runIn(web_, fmt::format("node test/ros2_check.mjs {} {}", what, quoted(path(name))));
    EXPECT_EQ(check.exit_code, 0) << check.output;
    return check.output;
  }

  const std::filesystem::path web_ = testSourceDir() / "web";
};

#define LODELINE_NEEDS_MCAP_PACKAGES                              \
  if (!std::filesystem::exists(web_ / "node_modules/@mcap/core")) \
  GTEST_SKIP() << "web/node_modules has no @mcap/core (npm ci in web/)"

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

TEST_F(Ros2BagTest, OtherProgramsReadTheSameInEveryCompression) {
  LODELINE_NEEDS_MCAP_PACKAGES;
  convert(recording_.data, "bag.db3");
  convert(recording_.data, "from_folder.mcap");
  const std::string expected = foreign("list", "from_folder.mcap");
  EXPECT_THAT(expected, AllOf(HasSubstr("/cam0/image_raw sensor_msgs/msg/Image 31 "),
                              HasSubstr("/cam1/image_raw sensor_msgs/msg/Image 31 "),
                              HasSubstr("/imu0 sensor_msgs/msg/Imu 401 ")));
  for (const char* compression : {"none", "lz4", "zstd"}) {
    for (const auto& from : {recording_.data, path("bag.db3")}) {
      const std::string name = fmt::format("{}_{}.mcap", from.stem().string(), compression);
      convert(from, name, fmt::format("--compression {}", compression));
      EXPECT_EQ(foreign("list", name), expected) << name;
    }
  }
}

TEST_F(Ros2BagTest, OtherProgramsReadTheReadingsAndPixelsOfTheRecording) {
  LODELINE_NEEDS_MCAP_PACKAGES;
  convert(recording_.data, "bag.db3");
  convert(path("bag.db3"), "from_bag.mcap");
  std::vector<std::string> read_rows;
  size_t images = 0;
  std::istringstream lines(foreign("values", "from_bag.mcap"));
  std::string time, topic, type, json;
  while (lines >> time >> topic >> type && std::getline(lines, json)) {
    const nlohmann::json message = nlohmann::json::parse(json);
    const auto& stamp = message["header"]["stamp"];
    const int64_t time_ns = stamp["sec"].get<int64_t>() * 1'000'000'000 + stamp["nanosec"].get<int64_t>();
    EXPECT_EQ(std::to_string(time_ns), time);
    if (topic == "/imu0") {
      std::array<double, 6> values{};
      for (size_t i = 0; i < 6; ++i) {
        const char* vector = i < 3 ? "angular_velocity" : "linear_acceleration";
        values[i] = message[vector][std::string(1, "xyz"[i % 3])].get<double>();
      }
      read_rows.push_back(imuRow(time_ns, values));
    } else if (topic == "/cam1/image_raw") {
      const cv::Mat image = cv::imread(recording_.image(1, images++).string(), cv::IMREAD_UNCHANGED);
      EXPECT_EQ(message["width"], image.cols);
      EXPECT_EQ(message["height"], image.rows);
      EXPECT_TRUE(message["data"].get<std::vector<uint8_t>>() ==
                  std::vector<uint8_t>(image.datastart, image.dataend));
    }
  }
  EXPECT_EQ(images, recording_.image_names.size());
  EXPECT_EQ(read_rows, recordedImuRows());
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

TEST_F(Ros2BagTest, ReadsNoTopicWhoseMetadataStatesAnotherSerialization) {
  for (const char* format : {"db3", "mcap"}) {
    const std::filesystem::path bag = path(fmt::format("folder_{}", format));
    convert(recording_.data, bag.filename().string(), fmt::format("--format {}", format));
    editLines(bag / "metadata.yaml", [](std::vector<std::string>& lines) {
      for (std::string& line : lines) {
        const size_t at = line.find("serialization_format: cdr");
        if (at != std::string::npos) line = line.substr(0, at) + "serialization_format: other";
      }
    });
    const Execution messages = runProgram(fmt::format("inspect {} --messages 3", quoted(bag)));
    EXPECT_THAT(messages.output, HasSubstr("serialization format 'other' of its messages is not read"))
        << format;
    EXPECT_EQ(messages.output.find("angular_velocity"), std::string::npos) << format;
    EXPECT_EQ(runProgram(fmt::format("run {} -o {}", quoted(bag), quoted(output_))).exit_code, 1) << format;
  }
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

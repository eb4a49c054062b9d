#include "apps/lodeline/tests/test_room.h"

// Tests of `lodeline convert-calibration`, `lodeline rig-template`, `--rig` for folders, and files of a wrong
// kind.

namespace lodeline::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class CalibrationFileTest : public RoomTest {
 protected:
  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }

  /// Converts the room's sensor.yaml files to one calibration file in another folder.
  std::filesystem::path moveCalibrationAway() const {
    std::string rig;
    for (const char* sensor : {"cam0", "cam1", "imu0"}) {
      const std::filesystem::path file = recording_.sensor(sensor) / "sensor.yaml";
      rig += fmt::format("{}:\n", sensor);
      std::istringstream yaml(readText(file));
      for (std::string line; std::getline(yaml, line);) rig += "  " + line + "\n";
      std::filesystem::remove(file);
    }
    folder_.write("elsewhere.yaml", rig);
    return path("elsewhere.yaml");
  }

  std::string trajectory() const { return readText(output_ / "trajectory.tum"); }
};

TEST_F(CalibrationFileTest, RigServesFoldersToo) {
  ASSERT_EQ(run("-q").exit_code, 0);
  const std::string expected = trajectory();
  const std::filesystem::path rig = moveCalibrationAway();
  std::filesystem::remove_all(output_);
  const Execution result = run(fmt::format("-q --rig {}", quoted(rig)));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_TRUE(trajectory() == expected);
  EXPECT_EQ(run("--topic imu0=/imu").exit_code, 2);
}

TEST_F(CalibrationFileTest, ConvertedCalibrationIsARigFile) {
  const std::filesystem::path rig = moveCalibrationAway();
  const std::filesystem::path converted = path("rig.yaml");
  const std::string command = fmt::format("convert-calibration {} -o {}", quoted(rig), quoted(converted));
  ASSERT_EQ(runProgram(command).exit_code, 0);
  EXPECT_THAT(runProgram(command).output, HasSubstr("is there already"));
  EXPECT_EQ(runProgram(command + " --overwrite").exit_code, 0);
  const std::string rig_template = "rig-template -o " + quoted(path("template.yaml"));
  EXPECT_EQ(runProgram(rig_template).exit_code, 0);
  EXPECT_EQ(runProgram(rig_template).exit_code, 1);
  EXPECT_EQ(runProgram(rig_template + " --overwrite").exit_code, 0);
  expectGoodResult(run(fmt::format("-q --rig {}", quoted(converted))));
}

TEST_F(CalibrationFileTest, CameraWithoutExtrinsicsIsSaid) {
  folder_.write(
      "info.yaml",
      "image_width: 752\nimage_height: 480\ncamera_name: left\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
      "  data: [458.654, 0, 367.215, 0, 457.296, 248.375, 0, 0, 1]\ndistortion_model: plumb_bob\n"
      "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [-0.28, 0.07, 0.0002, 0.00002, 0]\n");
  const Execution result = runProgram("convert-calibration " + quoted(path("info.yaml")));
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.output, AllOf(HasSubstr("intrinsics: [458.654, 457.296, 367.215, 248.375]"),
                                   HasSubstr("FILL IN"), HasSubstr("no file says how cam0 is mounted")));
}

TEST_F(CalibrationFileTest, TemplateIsARigFile) {
  ASSERT_EQ(runProgram("rig-template -o " + quoted(path("rig.yaml"))).exit_code, 0);
  EXPECT_EQ(runProgram("convert-calibration " + quoted(path("rig.yaml"))).exit_code, 0);
  EXPECT_EQ(runProgram("rig-template").output, readText(path("rig.yaml")));
}

TEST_F(CalibrationFileTest, FilesOfAWrongKindAreNamed) {
  using namespace std::string_literals;
  folder_.write("dive.zip", "PK\3\4");
  folder_.write("dive.mp4", "\0\0\0\x20"s + "ftypmp42");
  folder_.write("dive.db3", "SQLite format 3\0"s);
  folder_.write("dive.mcap", "\x89MCAP0\r\n");
  folder_.write("ros2/metadata.yaml", "rosbag2_bagfile_information: {}\n");
  folder_.write("ros2/ros2_0.db3", "SQLite format 3\0"s);
  folder_.write("loose/1.png", "");
  const std::vector<std::pair<const char*, const char*>> kinds = {
      {"dive.zip", "an archive"},
      {"dive.mp4", "no film that can be read"},
      {"dive.db3", "cannot be opened as a SQLite database"},
      {"dive.mcap", "holds no message"},
      {"ros2", "cannot be opened as a SQLite database"},
      {"loose", "pictures without a list"}};
  for (const auto& [name, words] : kinds) {
    for (const std::string& command :
         {fmt::format("run {} -o {}", quoted(path(name)), quoted(output_)),
          fmt::format("run {} -o {} --rig {}", quoted(path(name)), quoted(output_), quoted(path("rig.yaml"))),
          fmt::format("inspect {}", quoted(path(name))),
          fmt::format("attitude {} -o {}", quoted(path(name)), quoted(path("attitude.csv"))),
          fmt::format("allan {}", quoted(path(name))),
          fmt::format("calibrate magnetometer {} -o {}", quoted(path(name)), quoted(path("mag.yaml"))),
          fmt::format("convert {} {}", quoted(path(name)), quoted(path("out.bag")))}) {
      const Execution result = runProgram(command);
      // An archive may hold a sensor log, and a rig file is for recordings.
      const bool is_rig_of_log =
          name == std::string("dive.zip") && command.find("--rig") != std::string::npos;
      EXPECT_EQ(result.exit_code, is_rig_of_log ? 2 : 1) << command << "\n" << result.output;
      EXPECT_THAT(result.output, HasSubstr(words)) << command;
    }
  }
  for (const char* command : {"evaluate {} {}", "export {} -f kml"}) {
    const Execution result =
        runProgram(fmt::format(fmt::runtime(command), quoted(path("dive.zip")), quoted(path("dive.zip"))));
    EXPECT_EQ(result.exit_code, 1) << result.output;
    EXPECT_THAT(result.output, HasSubstr("an archive")) << command;
  }
}

}  // namespace
}  // namespace lodeline::test

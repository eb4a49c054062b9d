#include <yaml-cpp/yaml.h>

#include "apps/lodeline/tests/test_room.h"
#include "lodeline/io/euroc/csv_reader.h"
#include "lodeline/io/rosbag/test_bag.h"

// Tests of `lodeline run` and `lodeline convert` with ROS 1 bags.

namespace lodeline::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class BagTest : public RoomTest {
 protected:
  void SetUp() override {
    if (!hasRosbag()) GTEST_SKIP() << kRosbagMissing;
  }

  /// Adds sensors with unusual decimals: 17 digits, exponents, a repeated stamp and one out of order.
  void addSmallSensors() const {
    const char* transform = "T_BS: [1,0,0,0.1, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n";
    folder_.write("room/mav0/mag0/sensor.yaml",
                  std::string(transform) + "rate_hz: 50\nmagnetometer_noise_density: 1.0e-8\n");
    folder_.write(
        "room/mav0/mag0/data.csv",
        "#timestamp [ns],x,y,z\n1000000000001,2.0000000000000001e-05,-1.2345678901234567e-05,4e-05\n"
        "1000020000000,2.1e-05,-1.1e-05,4.1e-05\n1000020000000,2.2e-05,-1.1e-05,4.1e-05\n"
        "1000010000000,1e-05,3.0000000000000004e-05,5e-324\n1000060000000,2.3e-05,-1.1e-05,4.1e-05\n");
    folder_.write("room/mav0/pressure0/sensor.yaml",
                  std::string(transform) + "rate_hz: 2\ndepth_noise_std: 0.01\n");
    folder_.write("room/mav0/pressure0/data.csv",
                  "#timestamp [ns],depth [m]\n1000000000000,7.48\n1000500000000,12.345678\n");
    folder_.write("room/mav0/sonar0/sensor.yaml",
                  std::string(transform) + "rate_hz: 2\nrange_noise_std: 0.05\n");
    folder_.write(
        "room/mav0/sonar0/data.csv",
        "#timestamp [ns],range [m],angle [rad]\n1000000000000,3.12345,0.1\n1000500000000,4.1,-3.141593\n");
    folder_.write(
        "room/mav0/state_groundtruth_estimate0/data.csv",
        "#timestamp [ns],x,y,z,qw,qx,qy,qz\n1000000000000,0.1,0.2,0.30000000000000004,0.5,0.5,-0.5,0.5\n");
  }

  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }

  static std::filesystem::path rigFileOf(std::filesystem::path bag) {
    return bag.replace_extension(".rig.yaml");
  }

  std::string trajectory(const std::string& arguments, const std::string& output) const {
    const Execution result = runProgram(fmt::format("run {} -o {} -q", arguments, quoted(path(output))));
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return readText(path(output) / "trajectory.tum") + readText(path(output) / "states.csv");
  }

  /// A bag of the room in the format of another program, and the calibration file of `convert`.
  std::filesystem::path rosbagOfRoom(const std::string& compression, const std::string& images) const {
    addPgmImages(recording_.data / "mav0");
    const std::filesystem::path bag = path("room_" + compression + images + ".bag");
    runRosbag(
        fmt::format("write {} {} {} {}", quoted(recording_.data / "mav0"), quoted(bag), compression, images));
    std::string rig;
    for (const char* sensor : {"cam0", "cam1", "imu0"}) {
      rig += fmt::format("{}:\n", sensor);
      std::istringstream yaml(readText(recording_.sensor(sensor) / "sensor.yaml"));
      for (std::string line; std::getline(yaml, line);) rig += "  " + line + "\n";
    }
    folder_.write("room.rig.yaml", rig);
    return bag;
  }

  void expectSameReadings(const std::filesystem::path& a, const std::filesystem::path& b) const {
    Diagnostics diagnostics;
    for (const auto& [sensor, numbers] :
         {std::pair("imu0", 6), std::pair("mag0", 3), std::pair("pressure0", 1), std::pair("sonar0", 2),
          std::pair("state_groundtruth_estimate0", 7)}) {
      CsvReader one(a / "mav0" / sensor / "data.csv", numbers, &diagnostics);
      CsvReader other(b / "mav0" / sensor / "data.csv", numbers, &diagnostics);
      CsvRow row, same;
      int count = 0;
      for (; one.next(&row); ++count) {
        ASSERT_TRUE(other.next(&same)) << sensor;
        EXPECT_EQ(row.time, same.time) << sensor;
        EXPECT_EQ(row.numbers, same.numbers) << sensor;
      }
      EXPECT_FALSE(other.next(&same)) << sensor;
      EXPECT_GT(count, 0) << sensor;
    }
  }
};

TEST_F(BagTest, RunFromARosbagEqualsRunFromTheFolder) {
  const std::string expected = trajectory(quoted(recording_.data), "folder");
  for (const char* kind : {"none raw", "lz4 compressed"}) {
    const std::string compression(kind, std::string_view(kind).find(' '));
    const std::filesystem::path bag = rosbagOfRoom(compression, kind + compression.size() + 1);
    EXPECT_TRUE(trajectory(fmt::format("{} --rig {}", quoted(bag), quoted(path("room.rig.yaml"))),
                           compression) == expected)
        << kind;
  }
}

TEST_F(BagTest, ConvertsThereAndBackWithoutLoss) {
  addSmallSensors();
  for (const char* name :
       {"none.bag", "lz4.bag", "bz2.bag", "none.mcap", "lz4.mcap", "zstd.mcap", "none.db3"}) {
    const std::filesystem::path bag = path(name);
    const std::string compression = bag.stem().string();
    const std::filesystem::path back = path(fmt::format("{}_back", name));
    std::filesystem::remove(rigFileOf(bag));
    const Execution there = runProgram(
        fmt::format("convert {} {} --compression {}", quoted(recording_.data), quoted(bag), compression));
    ASSERT_EQ(there.exit_code, 0) << there.output;
    EXPECT_EQ(there.output.find("warning"), std::string::npos) << there.output;
    const Execution again = runProgram(fmt::format("convert {} {}", quoted(bag), quoted(back)));
    ASSERT_EQ(again.exit_code, 0) << again.output;
    expectSameReadings(recording_.data, back);
    for (int camera = 0; camera < 2; ++camera) {
      for (const std::string& name : recording_.image_names) {
        const std::filesystem::path below = fmt::format("mav0/cam{}/data/{}", camera, name);
        const cv::Mat before = cv::imread((recording_.data / below).string(), cv::IMREAD_UNCHANGED);
        const cv::Mat after = cv::imread((back / below).string(), cv::IMREAD_UNCHANGED);
        ASSERT_EQ(before.type(), after.type());
        ASSERT_EQ(cv::norm(before, after, cv::NORM_INF), 0.0) << below;
      }
    }
  }
  const std::string expected = trajectory(quoted(recording_.data), "folder");
  EXPECT_TRUE(trajectory(quoted(path("none.bag")), "from_bag") == expected);
  EXPECT_TRUE(trajectory(quoted(path("bz2.bag_back")), "from_back") == expected);
}

TEST_F(BagTest, RosbagReadsWhatConvertWrites) {
  addSmallSensors();
  const std::filesystem::path bag = path("room.bag");
  ASSERT_EQ(runProgram(fmt::format("convert {} {}", quoted(recording_.data), quoted(bag))).exit_code, 0);
  const std::string list = runRosbag("list " + quoted(bag));
  EXPECT_THAT(list,
              AllOf(HasSubstr("/cam0/image_raw sensor_msgs/Image 31 "),
                    HasSubstr("/ground_truth/pose geometry_msgs/PoseStamped 1 "),
                    HasSubstr("/imu0 sensor_msgs/Imu 401 "), HasSubstr("/mag0 sensor_msgs/MagneticField 5 "),
                    HasSubstr("/pressure0 sensor_msgs/FluidPressure 2 "),
                    HasSubstr("/sonar0 sensor_msgs/LaserScan 2 ")));
}

TEST_F(BagTest, TruncatedBagIsUsedUpToThere) {
  const std::filesystem::path bag = rosbagOfRoom("none", "raw");
  std::filesystem::resize_file(bag, std::filesystem::file_size(bag) * 7 / 10);
  const Execution result = runProgram(
      fmt::format("run {} -o {} --rig {}", quoted(bag), quoted(output_), quoted(path("room.rig.yaml"))));
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(findings("bag_truncated"), 1);
  EXPECT_THAT(result.output, HasSubstr("messages in"));
  EXPECT_GT(poses(), 15);
}

TEST_F(BagTest, ExportTakesCamerasAndImagesFromABag) {
  const std::filesystem::path bag = path("room.bag");
  ASSERT_EQ(runProgram(fmt::format("convert {} {}", quoted(recording_.data), quoted(bag))).exit_code, 0);
  ASSERT_EQ(run("-q --no-report").exit_code, 0);
  const auto model = [&](const std::filesystem::path& recording, const std::string& name) {
    const Execution result = runProgram(fmt::format("export {} -f colmap --recording {} -o {}",
                                                    quoted(output_), quoted(recording), quoted(path(name))));
    EXPECT_EQ(result.exit_code, 0) << result.output;
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path(name))) {
      if (entry.is_regular_file()) files[entry.path().filename().string()] = readText(entry.path());
    }
    return files;
  };
  const std::map<std::string, std::string> from_folder = model(recording_.data, "from_folder");
  EXPECT_THAT(from_folder.at("images.txt"), HasSubstr("cam1/data/"));
  EXPECT_EQ(model(bag, "from_bag"), from_folder);
}

TEST_F(BagTest, ConvertsAPartInAllDirections) {
  const auto convert = [&](const std::filesystem::path& from, const char* to, const char* part) {
    const Execution result =
        runProgram(fmt::format("convert {} {} {}", quoted(from), quoted(path(to)), part));
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return result.output.substr(0, result.output.find("calibration:"));
  };
  const auto counts = [](const std::string& output) { return output.substr(output.find('\n')); };
  convert(recording_.data, "all.bag", "");
  const std::string from_folder = counts(convert(recording_.data, "part.bag", "--from 0.5 --to 1"));
  EXPECT_THAT(from_folder, HasSubstr("imu0"));
  EXPECT_LT(std::filesystem::file_size(path("part.bag")), std::filesystem::file_size(path("all.bag")) / 2);
  EXPECT_EQ(counts(convert(path("all.bag"), "part_folder", "--from 0.5 --to 1")).substr(0, 60),
            from_folder.substr(0, 60));
  convert(path("all.bag"), "other_part.mcap", "--from 0.5 --to 1");
  EXPECT_EQ(runProgram(
                fmt::format("convert {} {} --from 2 --to 1", quoted(path("all.bag")), quoted(path("no.bag"))))
                .exit_code,
            2);
}

TEST_F(BagTest, APartWithoutImagesIsNamed) {
  // The images begin 0.5 s after the inertial readings.
  for (const char* to : {"blind.bag", "blind_folder"}) {
    const auto convert = [&](const std::string& part) {
      return runProgram(
          fmt::format("convert {} {} --overwrite {}", quoted(recording_.data), quoted(path(to)), part));
    };
    const Execution blind = convert("--from 0 --to 0.3");
    EXPECT_EQ(blind.exit_code, 0) << blind.output;
    EXPECT_THAT(blind.output, HasSubstr("has no image"));
    EXPECT_THAT(convert("--from 0 --to 0.8").output, Not(HasSubstr("has no image")));
  }
}

TEST_F(BagTest, ConvertsAFolderToAFolderWithoutLoss) {
  addSmallSensors();
  folder_.write("room/mav0/leica0/data.csv", "#timestamp, x\r\n1000000000000, 1.50\r\n1000700000000,2e0\r\n");
  folder_.write("room/mav0/leica0/sensor.yaml", "sensor_type: position\n");
  folder_.write("room/mav0/words0/data.csv", "#word\nfirst\nsecond\n");
  const Execution whole =
      runProgram(fmt::format("convert {} {}", quoted(recording_.data), quoted(path("whole"))));
  ASSERT_EQ(whole.exit_code, 0) << whole.output;
  EXPECT_THAT(whole.output, AllOf(HasSubstr("words0"), HasSubstr("the table is left out")));
  expectSameReadings(recording_.data, path("whole"));
  for (const std::string& name : recording_.image_names) {
    const std::filesystem::path below = "mav0/cam1/data/" + name;
    EXPECT_EQ(readText(path("whole") / below), readText(recording_.data / below));
  }
  for (const char* file : {"leica0/data.csv", "leica0/sensor.yaml", "state_groundtruth_estimate0/data.csv"})
    EXPECT_EQ(readText(path("whole/mav0") / file), readText(recording_.data / "mav0" / file)) << file;
  EXPECT_TRUE(trajectory(quoted(path("whole")), "from_whole") ==
              trajectory(quoted(recording_.data), "folder"));
}

TEST_F(BagTest, ConvertsAPartOfAFolderToAFolder) {
  addSmallSensors();
  const Execution part = runProgram(
      fmt::format("convert {} {} --from 0.6 --to 1", quoted(recording_.data), quoted(path("part"))));
  ASSERT_EQ(part.exit_code, 0) << part.output;
  const auto rowsOf = [](const std::filesystem::path& table) {
    std::vector<std::string> rows;
    std::istringstream text(readText(table));
    for (std::string line; std::getline(text, line);) {
      if (line.front() != '#') rows.push_back(line.substr(0, line.find(',')));
    }
    return rows;
  };
  // The first reading is an inertial one, or one of the small sensors.
  const int64_t start_ns =
      std::min<int64_t>(std::stoll(rowsOf(recording_.csv("imu0")).front()), 1'000'000'000'000);
  for (const char* sensor : {"cam0", "cam1", "imu0", "pressure0", "sonar0"}) {
    std::vector<std::string> expected = rowsOf(recording_.data / "mav0" / sensor / "data.csv");
    std::erase_if(expected, [&](const std::string& stamp) {
      const int64_t since_start_ns = std::stoll(stamp) - start_ns;
      return since_start_ns < 600'000'000 || since_start_ns > 1'000'000'000;
    });
    EXPECT_FALSE(expected.empty());
    EXPECT_EQ(rowsOf(path("part") / "mav0" / sensor / "data.csv"), expected) << sensor;
  }
  EXPECT_FALSE(std::filesystem::exists(path("part/mav0/mag0/data.csv")));
  EXPECT_THAT(part.output, HasSubstr("no row lies in the part"));  // the true state at 0 s
}

TEST_F(BagTest, ConvertsOneCameraOfTwo) {
  const auto convert = [&](const std::filesystem::path& from, const char* to) {
    const Execution result =
        runProgram(fmt::format("convert {} {} --cameras 1", quoted(from), quoted(path(to))));
    ASSERT_EQ(result.exit_code, 0) << result.output;
  };
  ASSERT_EQ(
      runProgram(fmt::format("convert {} {}", quoted(recording_.data), quoted(path("all.bag")))).exit_code,
      0);
  convert(recording_.data, "from_folder");
  convert(recording_.data, "from_folder.mcap");
  convert(path("all.bag"), "from_bag");
  convert(path("all.bag"), "bag_to_bag.mcap");
  for (const char* bag : {"from_folder.mcap", "bag_to_bag.mcap"}) {
    const std::string folder = std::string(bag) + "_folder";
    ASSERT_EQ(runProgram(fmt::format("convert {} {}", quoted(path(bag)), quoted(path(folder)))).exit_code, 0);
  }
  const auto calibration = [](const std::filesystem::path& sensor) {
    return YAML::Load(readText(sensor / "sensor.yaml"));
  };
  const YAML::Node expected = calibration(recording_.sensor("cam1"));
  for (const char* folder :
       {"from_folder", "from_bag", "from_folder.mcap_folder", "bag_to_bag.mcap_folder"}) {
    SCOPED_TRACE(folder);
    const std::filesystem::path mav0 = path(folder) / "mav0";
    EXPECT_FALSE(std::filesystem::exists(mav0 / "cam1"));
    EXPECT_EQ(YAML::Dump(calibration(mav0 / "cam0")["T_BS"]), YAML::Dump(expected["T_BS"]));
    const std::string name = recording_.image_names.back();
    const cv::Mat image = cv::imread((mav0 / "cam0" / "data" / name).string(), cv::IMREAD_UNCHANGED);
    const cv::Mat right =
        cv::imread((recording_.sensor("cam1") / "data" / name).string(), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(image.size(), right.size());
    EXPECT_EQ(cv::norm(image, right, cv::NORM_INF), 0.0);
  }
  EXPECT_EQ(
      runProgram(fmt::format("convert {} {} --cameras 2", quoted(path("all.bag")), quoted(path("no.bag"))))
          .exit_code,
      1);
}

TEST_F(BagTest, NeverOverwritesTheRecordingThatItConverts) {
  for (const std::string& target : {quoted(recording_.data), quoted(recording_.data / "mav0")}) {
    const Execution result =
        runProgram(fmt::format("convert {} {} --overwrite", quoted(recording_.data / "mav0"), target));
    EXPECT_EQ(result.exit_code, 2) << result.output;
  }
  EXPECT_TRUE(std::filesystem::exists(recording_.data / "mav0/imu0/data.csv"));
}

TEST_F(BagTest, SaysWhatToDo) {
  const std::filesystem::path bag = rosbagOfRoom("none", "compressed");
  const Execution no_rig = runProgram(fmt::format("run {} -o {}", quoted(bag), quoted(output_)));
  EXPECT_EQ(no_rig.exit_code, 1);
  EXPECT_THAT(no_rig.output, HasSubstr("describe the rig with --rig FILE"));
  EXPECT_EQ(runProgram(fmt::format("convert {} {}", quoted(bag), quoted(bag))).exit_code, 1);
  EXPECT_EQ(runProgram(fmt::format("convert {} {}", quoted(bag), quoted(recording_.data))).exit_code, 1);
  EXPECT_EQ(runProgram(fmt::format("convert {} {}", quoted(recording_.data), quoted(bag))).exit_code, 1);
  EXPECT_EQ(runProgram(fmt::format("run {} -o {} --topic cam0", quoted(bag), quoted(output_))).exit_code, 2);
  const Execution bare = runProgram(fmt::format("convert {} {}", quoted(bag), quoted(path("bare"))));
  EXPECT_EQ(bare.exit_code, 0);
  EXPECT_THAT(bare.output, HasSubstr("written without calibration"));
}

}  // namespace
}  // namespace lodeline::test

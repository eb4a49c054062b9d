#include "apps/lodeline/tests/test_room.h"
#include "lodeline/io/rosbag/test_bag.h"

// Tests of `lodeline inspect` as a program.

namespace lodeline::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class InspectTest : public RoomTest {
 protected:
  Execution inspect(const std::string& arguments) const {
    return runProgram(fmt::format("inspect {} --json {}", arguments, quoted(json_)));
  }

  nlohmann::json sensor(const std::string& name) const {
    const nlohmann::json json = readJson(json_);
    for (const auto& entry : json["sensors"]) {
      if (entry["sensor"] == name) return entry;
    }
    return {};
  }

  std::filesystem::path json_ = folder_.path() / "inspection.json";
};

TEST_F(InspectTest, SoundRecording) {
  const Execution result = inspect(quoted(recording_.data) + " --quiet");  // no progress, however slow
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, AllOf(StartsWith("nothing found that would hurt"), HasSubstr("imu0      good"),
                                   HasSubstr("cam0      good"), HasSubstr("cam1      good")));
  EXPECT_NEAR(sensor("imu0")["rate_hz"], 200.0, 0.1);
  EXPECT_EQ(sensor("cam0")["readings"], kRoomImages);
  EXPECT_EQ(sensor("cam1")["verdict"], "good");
}

TEST_F(InspectTest, BagSaysTheSameAsTheFolder) {
  if (!hasRosbag()) GTEST_SKIP() << kRosbagMissing;
  const std::filesystem::path bag = folder_.path() / "room.bag";
  ASSERT_EQ(runProgram(fmt::format("convert {} {}", quoted(recording_.data), quoted(bag))).exit_code, 0);
  const Execution from_folder = inspect(quoted(recording_.data));
  const nlohmann::json folder_imu = sensor("imu0"), folder_camera = sensor("cam0");
  const Execution from_bag = inspect(quoted(bag));
  ASSERT_EQ(from_bag.exit_code, 0) << from_bag.output;
  EXPECT_EQ(sensor("imu0"), folder_imu);
  EXPECT_EQ(sensor("cam0"), folder_camera);

  std::filesystem::remove(folder_.path() / "room.rig.yaml");
  const Execution bare = inspect(quoted(bag));
  ASSERT_EQ(bare.exit_code, 0) << bare.output;
  EXPECT_THAT(bare.output, HasSubstr("no rig file"));
  EXPECT_EQ(sensor("imu0")["readings"], folder_imu["readings"]);
}

TEST_F(InspectTest, ReadingsWithoutImages) {
  for (const char* camera : {"cam0", "cam1"}) std::filesystem::remove_all(recording_.sensor(camera));
  const Execution result = inspect(quoted(recording_.data));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output,
              AllOf(StartsWith("nothing found that would hurt"), HasSubstr("there are no images")));

  std::filesystem::remove(recording_.sensor("imu0") / "sensor.yaml");
  const Execution bare = inspect(quoted(recording_.data));
  EXPECT_EQ(bare.exit_code, 0);
  EXPECT_THAT(bare.output, HasSubstr("imu0/sensor.yaml: calibration file missing"));

  const Execution single_file = inspect(quoted(recording_.csv("imu0")));
  ASSERT_EQ(single_file.exit_code, 0) << single_file.output;
  EXPECT_THAT(single_file.output, HasSubstr("imu0      good"));
}

TEST_F(InspectTest, NamesAFaultFirst) {
  editLines(recording_.csv("imu0"), [](std::vector<std::string>& lines) {
    for (size_t i = 100; i < 120; ++i) lines.erase(lines.begin() + 100);
  });
  const Execution result = inspect(quoted(recording_.data));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, StartsWith("1. serious imu0: gaps"));
  EXPECT_EQ(readJson(json_)["findings"][0]["kind"], "gaps");
  EXPECT_EQ(sensor("imu0")["verdict"], "harmful");
}

TEST_F(InspectTest, RefusesWhatIsNoRecording) {
  EXPECT_EQ(inspect("/no/such/place").exit_code, 1);
  EXPECT_EQ(inspect(quoted(recording_.data) + " --site 29,-82,0").exit_code, 2);
}

}  // namespace
}  // namespace lodeline::test

#include "apps/lodeline/tests/test_room.h"

// Tests of `lodeline run` with missing or wrong calibration or configuration.

namespace lodeline::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

using RunCalibration = RoomTest;

TEST_F(RunCalibration, AbsentFileIsNamed) {
  for (const char* sensor : {"imu0", "cam0", "cam1"}) {
    const std::filesystem::path file = recording_.sensor(sensor) / "sensor.yaml";
    const std::string content = readText(file);
    std::filesystem::remove(file);
    const Execution result = run();
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.output, AllOf(HasSubstr("bad input"), HasSubstr(file.string())));
    std::ofstream(file) << content;
  }
}

TEST_F(RunCalibration, AbsentAndMalformedKeysAreNamed) {
  const std::filesystem::path file = recording_.sensor("cam0") / "sensor.yaml";
  const std::string content = readText(file);
  replaceText(file, "intrinsics", "intrinsic");
  Execution result = run();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, AllOf(HasSubstr(file.string()), HasSubstr("intrinsics")));

  std::ofstream(file) << content;
  replaceText(file, "[250", "[.nan");
  EXPECT_EQ(run().exit_code, 1);

  std::ofstream(file) << content << "]: {\n";
  result = run();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, HasSubstr(file.string()));
}

TEST_F(RunCalibration, UnknownKeyOfTheRecordingIsPassedOver) {
  std::ofstream(recording_.sensor("cam0") / "sensor.yaml", std::ios::app) << "lens_maker: unknown\n";
  expectGoodResult(run());
}

TEST_F(RunCalibration, UnknownSettingNamesTheNearestKey) {
  const auto config = folder_.write("run.yaml", "front_end:\n  max_track: 100\n");
  Execution result = run("-c " + quoted(config));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output,
              AllOf(HasSubstr(config.string()), HasSubstr("max_track"), HasSubstr("front_end.max_tracks")));
  result = run("--set front_end.max_track=100");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("front_end.max_tracks"));
}

TEST_F(RunCalibration, WrongSettingsAreUsageErrors) {
  EXPECT_EQ(run("--set front_end.max_tracks=many").exit_code, 2);
  EXPECT_EQ(run("--set front_end.max_tracks").exit_code, 2);
  EXPECT_EQ(run("-c " + quoted(folder_.path() / "absent.yaml")).exit_code, 2);
}

TEST_F(RunCalibration, EffectiveConfigurationReproducesTheRun) {
  ASSERT_EQ(run("--set front_end.max_tracks=120").exit_code, 0);
  const std::string trajectory = readText(output_ / "trajectory.tum");
  const std::filesystem::path config = folder_.path() / "used.yaml";
  std::filesystem::rename(output_ / "config.yaml", config);
  ASSERT_EQ(run("-c " + quoted(config)).exit_code, 0);
  EXPECT_EQ(readText(output_ / "trajectory.tum"), trajectory);
  EXPECT_EQ(readText(output_ / "config.yaml"), readText(config));
}

TEST_F(RunCalibration, CameraThatTheRecordingLacksIsBadInput) {
  const Execution result = run("--set source.cameras=[0,3]");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, HasSubstr("camera 3"));
}

}  // namespace
}  // namespace lodeline::test

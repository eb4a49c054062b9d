#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/lodeline/tests/test_program.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"

// Tests of `lodeline allan` as a program.

namespace lodeline {
namespace {

using test::Execution;
using test::runProgram;
using ::testing::HasSubstr;

class AllanTest : public ::testing::Test {
 protected:
  std::string file(const std::string& name) const { return test::quoted(folder_.path() / name); }

  test::TemporaryFolder folder_;
};

TEST_F(AllanTest, FindsTheNoiseOfASimulatedBenchRecord) {
  const Execution simulation = runProgram("simulate bench --seconds 240 --quiet -o " + file("bench"));
  ASSERT_EQ(simulation.exit_code, 0) << simulation.output;
  const Execution result =
      runProgram("allan " + file("bench") + " -o " + file("noise") + " --json " + file("noise.json"));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("too short for the random walk"));
  const auto json = test::readJson(folder_.path() / "noise.json");
  const auto white = [&](const char* sensor) {
    return json["sensors"][sensor]["all"]["white_noise"]["value"].get<double>();
  };
  // Values of the class gx5-25: 0.005 deg/s/sqrt(Hz), 25 ug/sqrt(Hz), 0.01 uT/sqrt(Hz).
  EXPECT_NEAR(white("gyroscope"), 8.727e-5, 0.05 * 8.727e-5);
  EXPECT_NEAR(white("accelerometer"), 2.452e-4, 0.05 * 2.452e-4);
  EXPECT_NEAR(white("magnetometer"), 1e-8, 0.05 * 1e-8);
  EXPECT_THAT(test::readText(folder_.path() / "noise" / "imu.yaml"), HasSubstr("gyroscope_random_walk: "));
  EXPECT_THAT(test::readText(folder_.path() / "noise" / "magnetometer.yaml"),
              HasSubstr("magnetometer_noise_density: "));
}

TEST_F(AllanTest, ReadsABagLikeAFolder) {
  ASSERT_EQ(runProgram("simulate bench --seconds 60 --quiet -o " + file("bench")).exit_code, 0);
  const Execution converted = runProgram("convert " + file("bench") + " " + file("bench.bag"));
  if (converted.exit_code == 2) GTEST_SKIP() << converted.output;  // built without librosbag-storage
  ASSERT_EQ(converted.exit_code, 0) << converted.output;
  std::filesystem::remove(folder_.path() / "bench.rig.yaml");  // not needed
  ASSERT_EQ(runProgram("allan " + file("bench") + " --json " + file("folder.json")).exit_code, 0);
  const Execution result = runProgram("allan " + file("bench.bag") + " --json " + file("bag.json"));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(test::readJson(folder_.path() / "bag.json")["sensors"],
            test::readJson(folder_.path() / "folder.json")["sensors"]);
  EXPECT_EQ(runProgram("allan " + file("bench") + " --rig " + file("bench.rig.yaml")).exit_code, 2);
}

TEST_F(AllanTest, EndsWithOneWhereThereIsNothingToAnalyse) {
  const Execution absent = runProgram("allan " + file("absent"));
  EXPECT_EQ(absent.exit_code, 1);
  EXPECT_THAT(absent.output, HasSubstr("absent"));
  folder_.write("one.csv", "t [s],wx [rad/s],wy [rad/s],wz [rad/s]\n0,0,0,0\n");
  const Execution one = runProgram("allan " + file("one.csv"));
  EXPECT_EQ(one.exit_code, 1);
  EXPECT_THAT(one.output, HasSubstr("1 usable readings"));
  std::string standing = "t [s],wx [rad/s],wy [rad/s],wz [rad/s]\n";
  for (int i = 0; i < 300; ++i) standing += "0,0.001,0,0\n";
  folder_.write("standing.csv", standing);
  EXPECT_THAT(runProgram("allan " + file("standing.csv")).output,
              HasSubstr("gyroscope: the first 50 readings all have the stamp 0 ns"));
  EXPECT_EQ(runProgram("allan " + file("one.csv") + " --from -1").exit_code, 2);
  EXPECT_EQ(runProgram("allan").exit_code, 2);
}

}  // namespace
}  // namespace lodeline

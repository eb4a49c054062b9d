#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/cli/test_program.h"
#include "lodeline/evaluation/test_trajectories.h"

// `lodeline attitude` as a script sees it.

namespace lodeline {
namespace {

using test::Execution;
using test::runProgram;
using ::testing::HasSubstr;

class AttitudeTest : public ::testing::Test {
 protected:
  std::string file(const std::string& name) const { return test::quoted(folder_.path() / name); }

  /// Ten seconds at 100 Hz, level, x axis pointing to an azimuth of 30 degrees, in the units of its header.
  void writeLevel(const std::string& name, bool with_field) {
    std::string text =
        with_field ? "t [s],gx [deg/s],gy [deg/s],gz [deg/s],ax [g],ay [g],az [g],mx [uT],my [uT],mz [uT]\n"
                   : "t [s],gx [deg/s],gy [deg/s],gz [deg/s],ax [g],ay [g],az [g]\n";
    for (int i = 0; i < 1000; ++i) {
      text += fmt::format("{:.2f},{},0.1,-0.1,0,0,{}", 0.01 * i, i % 2 == 0 ? 0.01 : -0.01,
                          i % 2 == 0 ? 1.001 : 0.999);
      // North, of 20 uT, is seen 30 degrees to the left of x.
      if (with_field)
        text += fmt::format(",{:.4f},10,{:.3f}", 20.0 * std::cos(M_PI / 6.0), -40.0 - 1e-3 * (i % 7));
      text += "\n";
    }
    folder_.write(name, text);
  }

  test::TemporaryFolder folder_;
};

TEST_F(AttitudeTest, FindsHeadingFromACsvFile) {
  writeLevel("level.csv", true);
  const Execution result = runProgram("attitude " + file("level.csv") + " -o " + file("out"));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("magnetic north"));
  EXPECT_THAT(result.output, HasSubstr("not calibrated"));
  const auto json = test::readJson(folder_.path() / "out" / "attitude.json");
  EXPECT_NEAR(json["end"]["heading_deg"].get<double>(), 30.0, 0.5);
  EXPECT_NEAR(json["gyroscope_bias_rad_per_s"][1].get<double>(), 0.1 * M_PI / 180.0, 1e-4);
  EXPECT_GT(json["status_share"]["magnetic"].get<double>(), 0.9);
  EXPECT_EQ(json["estimates"], 200);
  EXPECT_THAT(test::readText(folder_.path() / "out" / "attitude.csv"), HasSubstr(",magnetic,"));

  // Declination at Devil's Eye is 6.4 degrees to the west.
  const Execution at_site = runProgram("attitude " + file("level.csv") + " -o " + file("true") +
                                       " --site 29.83,-82.60,0 --date 2026-11-21");
  ASSERT_EQ(at_site.exit_code, 0) << at_site.output;
  EXPECT_THAT(at_site.output, HasSubstr("true north"));
}

TEST_F(AttitudeTest, GoesWithoutAMagnetometer) {
  writeLevel("level.csv", false);
  const Execution result = runProgram("attitude " + file("level.csv") + " -o " + file("out"));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("no magnetometer"));
}

TEST_F(AttitudeTest, ReadsRecordingsWithoutCameras) {
  ASSERT_EQ(runProgram("simulate figure_eight --seconds 30 --quiet -o " + file("eight")).exit_code, 0);
  const Execution result = runProgram("attitude " + file("eight") + " -o " + file("out") + " --rate-hz 0");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(test::readJson(folder_.path() / "out" / "attitude.json")["estimates"], 6001);
}

TEST_F(AttitudeTest, RefusesBadInputAndUsage) {
  folder_.write("field.csv", "0.0,1e-5,1e-5,1e-5\n0.1,1e-5,1e-5,2e-5\n");
  const Execution no_imu = runProgram("attitude " + file("field.csv") + " -o " + file("out"));
  EXPECT_EQ(no_imu.exit_code, 1);
  EXPECT_THAT(no_imu.output, HasSubstr("no gyroscope"));
  writeLevel("level.csv", true);
  EXPECT_EQ(runProgram("attitude " + file("absent") + " -o " + file("out")).exit_code, 1);
  EXPECT_EQ(runProgram("attitude " + file("level.csv")).exit_code, 2);
  EXPECT_EQ(runProgram("attitude " + file("level.csv") + " -o " + file("out") + " --site 1,2,3").exit_code,
            2);
  EXPECT_EQ(runProgram("attitude " + file("level.csv") + " -o " + file("out") + " --magnetometer-lag-s 3")
                .exit_code,
            2);
}

}  // namespace
}  // namespace lodeline

#include "lodeline/cli/test_magnetic_room.h"

// `lodeline run` on a recording with a magnetometer.

namespace lodeline::test {
namespace {

using ::testing::HasSubstr;

class RunMagnetometer : public MagneticRoomTest {};

TEST_F(RunMagnetometer, CalibratedTurnsTheTrajectoryToMagneticNorth) {
  const Execution result = runCalibrated();
  expectGoodResult(result);
  EXPECT_THAT(result.output, HasSubstr("magnetic north"));
  EXPECT_NEAR(headingError(), 0.0, 2.0 * kDegree);
  const nlohmann::json json = summary();
  EXPECT_EQ(json["heading"]["reference"], "magnetic north");
  EXPECT_GT(json["heading"]["sigma_rad"].get<double>(), 0.1 * kDegree);
  EXPECT_GT(json["magnetometer"]["frames"]["used"].get<int>(), 25);
  EXPECT_NEAR(json["magnetometer"]["field_W_T"][1].get<double>(), 24e-6, 2e-6);
  EXPECT_THAT(readText(output_ / "states.csv"), HasSubstr(",used,"));
}

TEST_F(RunMagnetometer, SiteAndDateTurnItToTrueNorth) {
  expectGoodResult(runCalibrated("--site 29.83,-82.60,0 --date 2026-11-21"));
  EXPECT_EQ(summary()["heading"]["reference"], "true north");
  // Magnetic north lies 6.38 degrees west of it there, so the world is turned to the east against it.
  EXPECT_NEAR(headingError(), 6.38 * kDegree, 2.0 * kDegree);
  // Elsewhere the field is another, and no heading comes of this one.
  expectGoodResult(runCalibrated("--site 0,-60,0 --date 2026-11-21"));
  EXPECT_EQ(summary()["heading"]["reference"], "start heading");
  EXPECT_EQ(findings("heading_not_aligned"), 1);
}

TEST_F(RunMagnetometer, UncalibratedIsLeftOutAndSaysSo) {
  expectGoodResult(run());
  EXPECT_EQ(summary()["heading"]["reference"], "start heading");
  EXPECT_EQ(findings("magnetometer_uncalibrated"), 1);
  const std::string trajectory = readText(output_ / "trajectory.tum");
  expectGoodResult(runCalibrated("--magnetometer off"));
  EXPECT_EQ(readText(output_ / "trajectory.tum"), trajectory);
  std::filesystem::remove_all(recording_.sensor("mag0"));
  expectGoodResult(run());
  EXPECT_EQ(readText(output_ / "trajectory.tum"), trajectory) << "not the same as without a magnetometer";
}

TEST_F(RunMagnetometer, AsInThePaperRunsToo) {
  expectGoodResult(runCalibrated("--magnetometer paper"));
  EXPECT_EQ(summary()["heading"]["reference"], "magnetic north");
  EXPECT_FALSE(summary()["magnetometer"].contains("field_W_T"));
}

TEST_F(RunMagnetometer, InGaussIsConvertedWithAWarning) {
  writeField(1e4);
  expectGoodResult(runCalibrated());
  EXPECT_EQ(findings("magnetometer_converted"), 1);
  EXPECT_EQ(summary()["heading"]["reference"], "magnetic north");
}

TEST_F(RunMagnetometer, WrongWordsAreUsageErrors) {
  for (const char* options : {"--magnetometer on", "--site 29.83,-82.60,0", "--date 2026-11-21",
                              "--site 29.83,-82.60 --date 2026-11-21",
                              "--site 29.83,-82.60,0 --date 21.11.2026", "--site here --date 2026-11-21"}) {
    EXPECT_EQ(run(options).exit_code, 2) << options;
  }
}

}  // namespace
}  // namespace lodeline::test

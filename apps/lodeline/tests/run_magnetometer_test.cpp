#include <cmath>
#include <fstream>
#include <limits>

#include "apps/lodeline/tests/test_magnetic_room.h"

// Tests of `lodeline run` on a recording with a magnetometer.

namespace lodeline::test {
namespace {

using ::testing::HasSubstr;

class RunMagnetometer : public MagneticRoomTest {
 protected:
  double firstHeadingError(const char* file) const {
    const StampedPose estimate = readPoses(output_ / file).poses.front();
    for (const StampedPose& truth : readPoses(recording_.truth).poses) {
      if (truth.time < estimate.time - Duration::fromSeconds(1e-3)) continue;
      return so3::log(estimate.world_from_body.rotation * truth.world_from_body.rotation.conjugate()).z();
    }
    return std::numeric_limits<double>::quiet_NaN();
  }
  int framesUsed() const { return summary()["magnetometer"]["frames"].value("used", 0); }
};

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
  // Magnetic north is 6.38 degrees west there, so the world is rotated to the east relative to it.
  EXPECT_NEAR(headingError(), 6.38 * kDegree, 2.0 * kDegree);
  // At another place the expected field differs, and this one gives no heading.
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

TEST_F(RunMagnetometer, InAnotherUnitIsConvertedWithAWarning) {
  for (const double per_tesla : {1e4, 1e6, 1e7}) {  // G, uT, mG
    writeField(per_tesla);
    expectGoodResult(runCalibrated());
    EXPECT_EQ(findings("magnetometer_converted"), 1) << per_tesla;
    EXPECT_EQ(summary()["heading"]["reference"], "magnetic north") << per_tesla;
    EXPECT_NEAR(headingError(), 0.0, 2.0 * kDegree) << per_tesla;
  }
}

TEST_F(RunMagnetometer, OfNoNumbersIsNoMagnetometer) {
  const Vec3 none = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  writeReadings([&](int, const Vec3&) { return none; });
  const Execution refused = runCalibrated();
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.output, HasSubstr("no magnetometer readings"));
  expectGoodResult(run());
  EXPECT_EQ(summary()["heading"]["reference"], "start heading");
  // Single invalid readings are skipped and the others used.
  writeReadings([&](int reading, const Vec3& field_B) { return reading % 3 == 1 ? none : field_B; });
  expectGoodResult(runCalibrated());
  EXPECT_EQ(summary()["heading"]["reference"], "magnetic north");
  EXPECT_NEAR(headingError(), 0.0, 2.0 * kDegree);
  EXPECT_GT(framesUsed(), 15);
}

TEST_F(RunMagnetometer, ThatFreezesIsUsedUpToThere) {
  Vec3 last = Vec3::Zero();
  const auto freeze = [&last](int reading, const Vec3& field_B) {
    if (reading < 6) last = field_B;
    return last;
  };
  writeReadings(freeze);
  expectGoodResult(runCalibrated());
  EXPECT_EQ(findings("magnetometer_frozen"), 1);
  EXPECT_NEAR(headingError(), 0.0, 2.0 * kDegree);
  EXPECT_LE(framesUsed(), 7);
  EXPECT_GE(framesUsed(), 4);
  EXPECT_GT(summary()["magnetometer"]["frames"]["no data"].get<int>(), 20);
  // If it is switched off, its faults are still reported.
  expectGoodResult(runCalibrated("--magnetometer off"));
  EXPECT_EQ(findings("magnetometer_frozen"), 1);
}

TEST_F(RunMagnetometer, AtTheEndOfItsRangeIsNotBelieved) {
  writeReadings([](int reading, const Vec3& field_B) {
    return Vec3(reading < 10 ? field_B : field_B.cwiseMin(15e-6).cwiseMax(-15e-6));
  });
  expectGoodResult(runCalibrated());
  EXPECT_NEAR(headingError(), 0.0, 2.0 * kDegree);
  EXPECT_LE(framesUsed(), 11);
  EXPECT_EQ(findings("magnetometer_rejected"), 1);
}

TEST_F(RunMagnetometer, MayBeSlowOrFast) {
  const auto leave = [](int, const Vec3& field_B) { return field_B; };
  for (const double rate_hz : {1.0, 1000.0}) {
    writeReadings(leave, rate_hz);
    expectGoodResult(runCalibrated());
    EXPECT_EQ(summary()["heading"]["reference"], "magnetic north") << rate_hz;
    EXPECT_NEAR(headingError(), 0.0, 2.0 * kDegree) << rate_hz;
    EXPECT_EQ(framesUsed() > 25, rate_hz > 20.0) << framesUsed() << " at " << rate_hz << " Hz";
  }
}

TEST_F(RunMagnetometer, ThatLagsIsTakenAtItsOwnTimeWhereTheLagIsKnown) {
  const auto leave = [](int, const Vec3& field_B) { return field_B; };
  expectGoodResult(runCalibrated());
  const double prompt = headingError();
  writeReadings(leave, 20.0, Duration::fromSeconds(0.2));
  expectGoodResult(runCalibrated());
  const double late = headingError();
  std::ofstream(calibration_, std::ios::app) << "time_offset_to_imu_s: -0.2\n";
  expectGoodResult(runCalibrated());
  EXPECT_LT(std::abs(headingError() - prompt), 0.3 * std::abs(late - prompt));
  EXPECT_GT(std::abs(late - prompt), 0.3 * kDegree) << "the lag does not matter here";
}

TEST_F(RunMagnetometer, ThatBeginsLateTurnsTheWholeRunToNorth) {
  const Vec3 none = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  writeReadings([&](int reading, const Vec3& field_B) { return reading < 10 ? none : field_B; });
  expectGoodResult(runCalibrated());
  EXPECT_EQ(summary()["heading"]["reference"], "magnetic north");
  EXPECT_NEAR(summary()["heading"]["north_found_after_s"].get<double>(), 0.5, 0.06);
  EXPECT_NEAR(headingError(), 0.0, 2.0 * kDegree);
  EXPECT_NEAR(firstHeadingError("trajectory.tum"), 0.0, 2.0 * kDegree);
  EXPECT_NEAR(summary()["magnetometer"]["field_W_T"][0].get<double>(), 0.0, 0.1e-6);
  EXPECT_THAT(readText(output_ / "landmarks.ply"), HasSubstr("y north (magnetic north)"));
  EXPECT_THAT(readText(output_ / "states.csv"), HasSubstr(",north_from_world [rad],"));
  expectGoodResult(runProgram("refine " + quoted(recording_.data) + " --overwrite -o " + quoted(output_) +
                              " --mag-calibration " + quoted(calibration_)));
  EXPECT_NEAR(firstHeadingError("trajectory_refined.tum"), 0.0, 2.0 * kDegree);
  EXPECT_THAT(readText(output_ / "landmarks_refined.ply"), HasSubstr("y north (magnetic north)"));
}

TEST_F(RunMagnetometer, WithoutItThePointsNameNoNorth) {
  expectGoodResult(run());
  EXPECT_THAT(readText(output_ / "landmarks.ply"), HasSubstr("x, y from the start heading"));
  EXPECT_THAT(readText(output_ / "landmarks.ply"), ::testing::Not(HasSubstr("east")));
}

TEST_F(RunMagnetometer, WithLeftHandedAxesIsDoubted) {
  writeReadings([&](int, const Vec3& field_B) { return Vec3(-field_B); });
  expectGoodResult(runCalibrated());
  EXPECT_EQ(findings("magnetic_field_upwards"), 1);
}

TEST_F(RunMagnetometer, WrongWordsAreUsageErrors) {
  for (const char* options :
       {"--magnetometer on", "--site 29.83,-82.60,0", "--date 2026-11-21", "--site 29.83 --date 2026-11-21",
        "--site 29.83,-82.60,0 --date 21.11.2026", "--site here --date 2026-11-21"}) {
    EXPECT_EQ(run(options).exit_code, 2) << options;
  }
}

}  // namespace
}  // namespace lodeline::test

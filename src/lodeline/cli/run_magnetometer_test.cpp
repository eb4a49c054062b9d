#include <cmath>
#include <numbers>

#include "lodeline/cli/test_room.h"
#include "lodeline/evaluation/read_trajectory.h"
#include "lodeline/geometry/so3.h"

// `lodeline run` on a recording with a magnetometer.

namespace lodeline::test {
namespace {

using ::testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180.0;
const Vec3 kField_W(0.0, 24e-6, -38e-6);

Trajectory read(const std::filesystem::path& file) {
  Diagnostics diagnostics;
  return readTrajectory(file, {}, diagnostics);
}

class RunMagnetometer : public RoomTest {
 protected:
  RunMagnetometer() {
    std::filesystem::create_directories(recording_.sensor("mag0"));
    std::ofstream(recording_.sensor("mag0") / "sensor.yaml")
        << "sensor_type: magnetometer\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, "
           "1, 0, "
           "0, 0, 0, 1]\nrate_hz: 20\nmagnetometer_noise_density: 1e-8\n";
    calibration_ = folder_.write("mag.yaml",
                                 "iron_correction: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n"
                                 "hard_iron_T: [0, 0, 0]\n");
    writeField(1.0);
  }

  /// The field at the true poses, the images' times.
  void writeField(double per_tesla) const {
    std::ofstream csv(recording_.csv("mag0"));
    csv << "#timestamp [ns],m_x [T],m_y [T],m_z [T]\n";
    int row = 0;
    for (const StampedPose& pose : read(recording_.truth).poses) {
      // A little noise, so that no reading is the same as the one before.
      const Vec3 field =
          per_tesla * (pose.world_from_body.rotation.conjugate() * kField_W + Vec3::Constant(1e-11 * ++row));
      csv << fmt::format("{},{},{},{}\n", pose.time.nanoseconds(), field.x(), field.y(), field.z());
    }
  }

  Execution runCalibrated(const std::string& options = "") const {
    return run("--mag-calibration " + quoted(calibration_) + " " + options);
  }

  /// Yaw by which the last pose is off the truth, rad.
  double headingError() const {
    const Rigid3 estimate = read(output_ / "trajectory.tum").poses.back().world_from_body;
    const Rigid3 truth = read(recording_.truth).poses.back().world_from_body;
    return so3::log(estimate.rotation * truth.rotation.conjugate()).z();
  }

  std::filesystem::path calibration_;
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

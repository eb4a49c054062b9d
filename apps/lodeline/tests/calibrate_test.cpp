#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "apps/lodeline/tests/test_program.h"
#include "apps/lodeline/tests/test_room.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/io/calibration/yaml_file.h"
#include "lodeline/magnetometer/calibration/calibration_file.h"

// Tests of `lodeline calibrate magnetometer` as a program, on simulated recordings.

namespace lodeline {
namespace {

using test::Execution;
using test::runProgram;
using ::testing::HasSubstr;

class CalibrateTest : public ::testing::Test {
 protected:
  std::string file(const std::string& name) const { return test::quoted(folder_.path() / name); }

  void simulate(const std::string& name, const std::string& options) {
    const Execution result = runProgram("simulate figure_eight --quiet -o " + file(name) + " " + options);
    ASSERT_EQ(result.exit_code, 0) << result.output;
  }

  Execution calibrate(const std::string& arguments) const {
    return runProgram("calibrate magnetometer " + arguments);
  }

  MagnetometerFit fitOf(const std::string& name) const { return readCalibrationFile(folder_.path() / name); }

  /// True parameters of the simulated sensor; soft iron as A with determinant 1.
  struct Truth {
    Mat3 correction;
    Vec3 hard_iron_T;
    Quat body_from_magnetometer;
  };
  Truth truthOf(const std::string& name) const {
    const std::filesystem::path path = folder_.path() / name / "truth" / "errors.yaml";
    CalibrationMap map(loadYamlFile(path)["magnetometer"], path, "magnetometer");
    const Mat3 correction = map.matrix3("soft_iron").inverse();
    return {correction / std::cbrt(correction.determinant()), map.vector3("hard_iron_T"),
            Quat(map.matrix3("rotation_body_from_magnetometer"))};
  }

  test::TemporaryFolder folder_;
};

TEST_F(CalibrateTest, ReachesTheBarsOnFiguresOfEightWithHonestSigmas) {
  constexpr int kSeeds = 6;
  double sum = 0.0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    simulate(fmt::format("eight{}", seed), fmt::format("--seed {}", seed));
    const Execution result = calibrate(file(fmt::format("eight{}", seed)) + " -o " + file("mag.yaml"));
    ASSERT_EQ(result.exit_code, 0) << result.output;
    const MagnetometerFit fit = fitOf("mag.yaml");
    const Truth truth = truthOf(fmt::format("eight{}", seed));
    Eigen::Matrix<double, 12, 1> error;
    error << symmetricEntries(fit.iron_correction - truth.correction), fit.hard_iron - truth.hard_iron_T,
        so3::log(*fit.body_from_magnetometer * truth.body_from_magnetometer.conjugate());
    EXPECT_LT(error.segment<3>(6).norm(), 0.05e-6) << seed;
    EXPECT_LT(error.head<6>().cwiseAbs().maxCoeff(), 1e-3) << seed;
    EXPECT_LT(error.tail<3>().norm(), 0.1 * M_PI / 180.0) << seed;
    // The common scale is fixed and has no variance: pseudo-inverse over scaled parameters.
    const Eigen::Matrix<double, 12, 1> scale = fit.sigmas().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * fit.covariance * scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
    const Eigen::VectorXd along = solver.eigenvectors().transpose() * scale.asDiagonal() * error;
    for (int i = 1; i < 12; ++i) sum += along[i] * along[i] / solver.eigenvalues()[i];
  }
  // The mean of chi-square with 11 degrees of freedom over the seeds: 11 +- 3 sigma.
  EXPECT_NEAR(sum / kSeeds, 11.0, 3.0 * std::sqrt(22.0 / kSeeds));
}

TEST_F(CalibrateTest, FindsTheLagOfAFieldRecordingAndComparesCalibrations) {
  simulate("clean", "--seed 3");
  simulate("late", "--seed 3 --effect magnetometer_lag=on");
  ASSERT_EQ(calibrate(file("clean") + " -o " + file("clean.yaml")).exit_code, 0);
  const Execution result =
      calibrate(file("late") + " -o " + file("late.yaml") + " --compare " + file("clean.yaml") + " --json " +
                file("late.json") + " --plots " + file("plots"));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NEAR(*fitOf("late.yaml").time_offset_to_imu_s, -0.015, 1.5e-3);
  EXPECT_THAT(result.output, HasSubstr("repeat the one before"));
  EXPECT_THAT(result.output, HasSubstr("second calibration minus first"));
  const nlohmann::json json = test::readJson(folder_.path() / "late.json");
  EXPECT_EQ(json["model"], "full");
  EXPECT_LT(json["comparison"]["heading_rms_deg"], 0.2);
  const Execution files = calibrate(file("late.yaml") + " --compare " + file("clean.yaml"));
  EXPECT_EQ(files.exit_code, 0) << files.output;
}

TEST_F(CalibrateTest, ReadsABagLikeAFolder) {
  simulate("eight", "");
  const Execution converted = runProgram("convert " + file("eight") + " " + file("eight.bag"));
  if (converted.exit_code == 2) GTEST_SKIP() << converted.output;  // built without librosbag-storage
  ASSERT_EQ(converted.exit_code, 0) << converted.output;
  ASSERT_EQ(calibrate(file("eight") + " -o " + file("folder.yaml")).exit_code, 0);
  const Execution result = calibrate(file("eight.bag") + " -o " + file("bag.yaml"));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const MagnetometerFit folder = fitOf("folder.yaml");
  const MagnetometerFit bag = fitOf("bag.yaml");
  EXPECT_LT((bag.hard_iron - folder.hard_iron).norm(), 1e-12);
  EXPECT_LT((bag.iron_correction - folder.iron_correction).norm(), 1e-9);
  EXPECT_LT(bag.body_from_magnetometer->angularDistance(*folder.body_from_magnetometer), 1e-9);
  std::filesystem::remove(folder_.path() / "eight.rig.yaml");
  EXPECT_EQ(calibrate(file("eight.bag") + " -o " + file("bare.yaml")).exit_code, 0);
}

TEST_F(CalibrateTest, RefusesATooShortPartAndWritesNothing) {
  simulate("eight", "");
  const Execution result = calibrate(file("eight") + " --to 4 -o " + file("mag.yaml"));
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.output, HasSubstr("How to move"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "mag.yaml"));
}

TEST_F(CalibrateTest, TellsWrongUseFromBadInput) {
  folder_.write("rows.txt", "1 2 3\n4 5 6\n");
  EXPECT_EQ(runProgram("calibrate").exit_code, 2);
  EXPECT_EQ(calibrate("").exit_code, 2);
  EXPECT_EQ(calibrate(file("rows.txt") + " --unit tesla").exit_code, 2);
  EXPECT_EQ(calibrate(file("rows.txt") + " --site 20,-87,0").exit_code, 2);
  EXPECT_EQ(calibrate(file("rows.txt") + " --site 20,-87,0 --date 2026-11-31").exit_code, 2);
  EXPECT_EQ(calibrate(file("rows.txt") + " --site 20 --date 2026-11-21").exit_code, 2);
  EXPECT_EQ(calibrate(file("rows.txt")).exit_code, 3);
  EXPECT_EQ(calibrate(file("absent")).exit_code, 1);
  EXPECT_EQ(calibrate(file("rows.txt") + " --old " + file("absent.yaml")).exit_code, 1);
}

using CalibratedRun = test::RoomTest;

TEST_F(CalibratedRun, NeedsAMagnetometerAndAReadableCalibration) {
  const std::filesystem::path file = folder_.path() / "mag.yaml";
  writeCalibrationFile({}, file);
  Execution result = run("--mag-calibration " + test::quoted(file));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, HasSubstr("no magnetometer readings"));
  folder_.write("mag.yaml", "iron_correction: [1, 2]\nhard_iron_T: [0, 0, 0]\n");
  result = run("--mag-calibration " + test::quoted(file));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, HasSubstr(file.string() + ":1"));
}

}  // namespace
}  // namespace lodeline

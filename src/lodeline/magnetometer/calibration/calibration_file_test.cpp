#include "lodeline/magnetometer/calibration/calibration_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

MagnetometerFit exampleFit() {
  MagnetometerFit fit;
  fit.model = IronModel::Diagonal;
  fit.iron_correction << 1.01, 0.02, -0.003, 0.02, 0.97, 1.0 / 3.0e2, -0.003, 1.0 / 3.0e2, 1.1;
  fit.hard_iron = Vec3(3.1e-6, -1.0e-5 / 3.0, 7.0e-7);
  fit.body_from_magnetometer = so3::exp(Vec3(0.01, -0.02, 1.5));
  fit.time_offset_to_imu_s = -0.0148;
  fit.time_offset_sigma_s = 1.0e-4;
  fit.noise_density_T_per_sqrtHz = 1.1e-8;
  fit.field_strength_T = 4.56e-5;
  fit.field_strength_known = true;
  fit.dip_rad = 1.01;
  fit.covariance = MagnetometerFit::Covariance::Random() * 1e-9;
  fit.covariance = (fit.covariance * fit.covariance.transpose()).eval();
  fit.residual_T = 7.1e-8;
  fit.coverage_share = 0.83;
  fit.condition_number = 12.5;
  fit.rejected_share = 0.02;
  fit.readings = 4500;
  fit.heading_error_rad = 1e-3;
  fit.axes_sigma_rad = 7e-4;
  fit.verdict = "say \"good\"";
  return fit;
}

class CalibrationFile : public ::testing::Test {
 protected:
  /// The error message of reading `text`.
  std::string errorOf(const std::string& text) {
    folder_.write("mag.yaml", text);
    try {
      readCalibrationFile(file_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "mag.yaml";
};

TEST_F(CalibrationFile, ReadsBackWhatWasWritten) {
  const MagnetometerFit fit = exampleFit();
  writeCalibrationFile(fit, file_);
  const MagnetometerFit read = readCalibrationFile(file_);
  EXPECT_EQ(read.model, fit.model);
  EXPECT_EQ(read.iron_correction, fit.iron_correction);
  EXPECT_EQ(read.hard_iron, fit.hard_iron);
  EXPECT_FALSE(read.raw_readings);
  EXPECT_LT(read.body_from_magnetometer->angularDistance(*fit.body_from_magnetometer), 1e-7);
  EXPECT_EQ(read.covariance, fit.covariance);
  EXPECT_EQ(read.axes_sigma_rad, fit.axes_sigma_rad);
  EXPECT_EQ(read.time_offset_to_imu_s, fit.time_offset_to_imu_s);
  EXPECT_EQ(read.dip_rad, fit.dip_rad);
  EXPECT_EQ(read.verdict, fit.verdict);
  EXPECT_TRUE(read.field_strength_known);
  // Writing the read file again gives the same text, so no information was lost.
  EXPECT_EQ(calibrationYaml(read).substr(0, 400), calibrationYaml(fit).substr(0, 400));
}

TEST_F(CalibrationFile, TakesTheLeastThatMakesACalibration) {
  folder_.write("mag.yaml", "iron_correction: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nhard_iron_T: [1e-6, 0, 0]\n");
  const MagnetometerFit fit = readCalibrationFile(file_);
  EXPECT_EQ(fit.hard_iron, Vec3(1e-6, 0, 0));
  EXPECT_FALSE(fit.body_from_magnetometer);
}

TEST_F(CalibrationFile, NamesFileLineAndKeyOfWhatIsWrong) {
  const std::string iron = "iron_correction: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n";
  const std::string name = file_.string();
  EXPECT_THAT(errorOf(iron), AllOf(HasSubstr(name), HasSubstr("hard_iron_T"), HasSubstr("missing")));
  EXPECT_THAT(errorOf(iron + "hard_iron_T: [1, 2]\n"), AllOf(HasSubstr(name + ":2"), HasSubstr("2 numbers")));
  EXPECT_THAT(errorOf(iron + "hard_iron_T: [1, 2, x]\n"),
              AllOf(HasSubstr("line 2"), HasSubstr("hard_iron_T")));
  EXPECT_THAT(errorOf(iron + "hard_iron_T: [0, 0, 0]\nmodle: full\n"),
              AllOf(HasSubstr(name + ":3"), HasSubstr("did you mean 'model'")));
  EXPECT_THAT(errorOf(iron + "hard_iron_T: [0, 0, 0]\nmodel: best\n"), HasSubstr("full, diagonal"));
  EXPECT_THAT(errorOf("hard_iron_T: [0, 0, 0]\niron_correction: [1, 0.1, 0, 0, 1, 0, 0, 0, 1]\n"),
              AllOf(HasSubstr(name + ":2"), HasSubstr("symmetric")));
  EXPECT_THAT(errorOf("hard_iron_T: [0, 0, 0]\niron_correction: [1, 0, 0, 0, -1, 0, 0, 0, 1]\n"),
              HasSubstr("positive definite"));
  EXPECT_THAT(errorOf("hard_iron_T: [0, 0, 0]\niron_correction: [.nan, 0, 0, 0, 1, 0, 0, 0, 1]\n"),
              HasSubstr(name + ":2"));
  EXPECT_THAT(errorOf("a: [b\n"), HasSubstr("not valid YAML"));
}

TEST_F(CalibrationFile, IsAppliedToTheRig) {
  Rig rig;
  rig.magnetometer.emplace();
  rig.magnetometer->body_from_magnetometer.translation = Vec3(0.1, 0, 0);
  rig.magnetometer->rate_hz = 77.0;
  MagnetometerFit fit = exampleFit();
  applyCalibration(fit, file_, &rig);
  const MagnetometerCalibration& magnetometer = *rig.magnetometer;
  EXPECT_TRUE(magnetometer.is_calibrated);
  EXPECT_EQ(magnetometer.rate_hz, 77.0);
  EXPECT_EQ(magnetometer.body_from_magnetometer.translation, Vec3(0.1, 0, 0));
  EXPECT_EQ(magnetometer.time_offset_to_imu_s, -0.0148);
  const Vec3 field_B(1e-5, 2e-5, -4e-5);
  const Vec3 reading =
      fit.iron_correction.inverse() * (fit.body_from_magnetometer->conjugate() * field_B) + fit.hard_iron;
  EXPECT_LT((magnetometer.corrected_B(reading) - field_B).norm(), 1e-15);

  // A file without a rotation keeps that of the recording.
  const Quat before = magnetometer.body_from_magnetometer.rotation;
  fit.body_from_magnetometer.reset();
  applyCalibration(fit, file_, &rig);
  EXPECT_EQ(rig.magnetometer->body_from_magnetometer.rotation.coeffs(), before.coeffs());
}

TEST_F(CalibrationFile, IsRefusedWhereItCannotApply) {
  Rig rig;
  EXPECT_THROW(applyCalibration(exampleFit(), file_, &rig), InputError);
  rig.magnetometer.emplace();
  MagnetometerFit raw = exampleFit();
  raw.raw_readings = true;
  writeCalibrationFile(raw, file_);
  EXPECT_TRUE(readCalibrationFile(file_).raw_readings);
  EXPECT_THROW(applyCalibration(raw, file_, &rig), InputError);
}

}  // namespace
}  // namespace lodeline

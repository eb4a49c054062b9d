#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/evaluation/trajectory/text_table.h"
#include "lodeline/magnetometer/calibration/calibrate_magnetometer.h"
#include "lodeline/util/files/test_data.h"

// Recordings of real sensors.

namespace lodeline {
namespace {

using ::testing::HasSubstr;

class RealCloud : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto folder = testData("magcal");
    if (!folder) GTEST_SKIP() << missingTestData("magcal");
    clouds_ = *folder;
  }

  MagnetometerCalibrationResult calibrated(const std::filesystem::path& file,
                                           const CalibrationOptions& options = {}) {
    return calibrateMagnetometer(readMagnetometerRecord(file, {}, &diagnostics_), options, &diagnostics_);
  }

  std::string refusalOf(const std::filesystem::path& file, const CalibrationOptions& options = {}) {
    try {
      const auto result = calibrated(file, options);
      return std::string("not refused: ") + toString(result.fit.model);
    } catch (const EstimationError& error) {
      return error.what();
    }
  }

  /// The magnetometer columns of the flight, with their time.
  std::filesystem::path flight() {
    std::istringstream lines(readFileBytes(clouds_ / "magnav_Flt1002_1002.02_fluxgate_ins_igrf.txt.gz"));
    std::string rows;
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string time, x, y, z;
      if (words >> time >> x >> y >> z) rows += time + "," + x + "," + y + "," + z + "\n";
    }
    return folder_.write("flight.csv", rows);
  }

  std::filesystem::path clouds_;
  test::TemporaryFolder folder_;
  Diagnostics diagnostics_;
};

TEST_F(RealCloud, AgreesWithAPublishedCalibration) {
  const auto result = calibrated(clouds_ / "jremington_mpu9250_mag3_raw.csv");
  EXPECT_EQ(result.fit.model, IronModel::Full);
  EXPECT_TRUE(result.fit.raw_readings);
  // Values of jremington_mpu9250_mag3_reference_result.txt, which scales to 1000.
  const Vec3 bias(9955.151669, -7948.26463057, 8511.80447932);
  Mat3 matrix;
  matrix << 0.25060005, 0.02941951, -0.02954944, 0.02941951, 0.31691521, 0.00788726, -0.02954944, 0.00788726,
      0.30592214;
  const double radius = 1000.0 / std::cbrt(matrix.determinant());
  EXPECT_LT((result.fit.hard_iron - bias).norm(), 1e-3 * radius);
  const Mat3 scaled = result.fit.iron_correction / std::cbrt(result.fit.iron_correction.determinant());
  EXPECT_LT((scaled - matrix / std::cbrt(matrix.determinant())).cwiseAbs().maxCoeff(), 2e-3);
  EXPECT_NEAR(result.fit.coverage_share, 0.99, 0.01);
  EXPECT_NEAR(result.fit.residual_T / result.fit.field_strength_T, 0.015, 0.001);
  // The published bias is well within the uncertainty from the scatter and its correlation.
  EXPECT_LT((result.fit.hard_iron - bias).cwiseAbs().maxCoeff(), result.fit.sigmas()[6]);
}

TEST_F(RealCloud, FitsACloudWithOutliers) {
  const auto result = calibrated(clouds_ / "aleksandrbazhin_hmc_mag_out.txt");
  EXPECT_EQ(result.fit.model, IronModel::Full);
  EXPECT_EQ(diagnostics_.count("magnetometer_unit"), 1);  // read as milligauss
  EXPECT_LT((1e7 * result.fit.hard_iron - Vec3(-68.1, 82.8, -133.4)).norm(), 2.0);
  EXPECT_LT(result.fit.residual_T / result.fit.field_strength_T, 0.035);
}

TEST_F(RealCloud, RefusesADegenerateCloud) {
  const std::string refusal = refusalOf(clouds_ / "nliaudat_degenerate_low_coverage.txt");
  EXPECT_THAT(refusal, HasSubstr("cannot calibrate"));
  EXPECT_THAT(refusal, HasSubstr("+z, -z"));
}

TEST_F(RealCloud, NeverFitsTheFullModelToAFlight) {
  const std::filesystem::path file = flight();
  EXPECT_THAT(refusalOf(file), HasSubstr("cannot calibrate"));
  // With a known field magnitude, the offset alone could be estimated, but with a large uncertainty.
  CalibrationOptions options;
  options.site_field_ENU = 1e-9 * Vec3(-3975.99, 17751.13, -50750.94);
  EXPECT_THAT(refusalOf(file, options), HasSubstr("equivalent heading error would be"));
  options.old.emplace();
  options.old->field_strength_T = options.site_field_ENU->norm();
  EXPECT_NE(calibrated(file, options).fit.model, IronModel::Full);
}

TEST_F(RealCloud, NeverFitsTheFullModelToARecordWithoutTurns) {
  const std::filesystem::path file =
      folder_.write("xio.csv", readFileBytes(clouds_ / "xio_fusion_sensor_data.csv.gz"));
  EXPECT_THAT(refusalOf(file), HasSubstr("cannot calibrate"));
  CalibrationOptions options;
  options.site_field_ENU = 1e-6 * Vec3(0.0, 18.0, -40.0);
  Diagnostics diagnostics;
  try {
    const auto result = calibrated(file, options);
    EXPECT_NE(result.fit.model, IronModel::Full);
    EXPECT_GT(result.fit.heading_error_rad, 0.01);
  } catch (const EstimationError& error) {
    EXPECT_THAT(error.what(), HasSubstr("cannot calibrate"));
  }
}

// BROAD's magnetometer has a lag and repeats 29 % of its rows. Its field has a magnitude of 43 to 45 uT and a
// dip of 69 degrees.
TEST_F(RealCloud, FindsTheLagAndTheRotationOfARecordingWithGyroscope) {
  const auto broad = testData("broad");
  if (!broad) GTEST_SKIP() << missingTestData("broad");
  std::istringstream lines(readFileBytes(*broad / "02_undisturbed_slow_rotation_B.csv.gz"));
  std::string rows =
      "t [s],wx [rad/s],wy [rad/s],wz [rad/s],ax [m/s^2],ay [m/s^2],az [m/s^2],mx [uT],my [uT],mz [uT]\n";
  std::string line;
  std::getline(lines, line);  // the header
  for (int i = 0; std::getline(lines, line); ++i) {
    size_t end = 0;
    for (int column = 0; column < 9; ++column) end = line.find(',', end + 1);
    rows += fmt::format("{:.7f},{}\n", i / 285.7142857, line.substr(0, end));
  }
  const auto result = calibrated(folder_.write("broad.csv", rows));
  EXPECT_EQ(result.fit.model, IronModel::Full);
  ASSERT_TRUE(result.inertial) << result.without_inertial;
  EXPECT_TRUE(result.inertial->time_offset_significant);
  EXPECT_LT(*result.fit.time_offset_to_imu_s, -0.009);
  EXPECT_GT(*result.fit.time_offset_to_imu_s, -0.017);
  // Both sensors are in one package with a factory calibration.
  EXPECT_LT(result.fit.body_from_magnetometer->angularDistance(Quat::Identity()), 0.03);
  EXPECT_LT(result.fit.hard_iron.norm(), 1e-6);
  EXPECT_NEAR(*result.fit.dip_rad, 1.21, 0.05);
  EXPECT_NEAR(result.fit.field_strength_T, 44e-6, 1.5e-6);
}

}  // namespace
}  // namespace lodeline

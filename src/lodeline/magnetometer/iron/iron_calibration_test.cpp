#include "lodeline/magnetometer/iron/iron_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/magnetometer/iron/test_cloud.h"

namespace lodeline {
namespace {

using test::CloudTruth;
using ::testing::HasSubstr;

constexpr double kField_T = 45e-6;

/// Readings in T of a sensor whose A has determinant 1, in directions down to a cosine with its z axis.
std::vector<Vec3> readings_T(double least_cosine, CloudTruth truth = {}) {
  truth.correction /= std::cbrt(truth.correction.determinant());
  truth.sigma = 2e-3;
  truth.least_cosine = least_cosine;
  std::vector<Vec3> readings = test::cloud(truth, 600);
  for (Vec3& reading : readings) reading *= kField_T;
  return readings;
}

std::string refusalOf(const std::vector<Vec3>& readings, const IronCalibrationOptions& options = {}) {
  try {
    calibrateIron(readings, options);
  } catch (const EstimationError& error) {
    return error.what();
  }
  return "not refused";
}

TEST(IronCalibration, FitsTheFullModelToTheWholeSphere) {
  const IronCalibration result = calibrateIron(readings_T(-1.0), {});
  EXPECT_EQ(result.fit.model, IronModel::Full);
  EXPECT_TRUE(result.refusals.empty());
  EXPECT_LT((result.fit.hard_iron - kField_T * CloudTruth().hard_iron).norm(), 0.02e-6);
  EXPECT_NEAR(result.fit.iron_correction.determinant(), 1.0, 1e-9);
  EXPECT_NEAR(result.fit.field_strength_T, kField_T, 1e-3 * kField_T);
  EXPECT_DOUBLE_EQ(result.fit.coverage_share, 1.0);
  EXPECT_LT(result.fit.heading_error_rad, 1e-3);
}

TEST(IronCalibration, TakesTheScaleFromTheSite) {
  IronCalibrationOptions options;
  options.field_strength_T = 50e-6;
  const IronCalibration result = calibrateIron(readings_T(-1.0), options);
  EXPECT_TRUE(result.fit.field_strength_known);
  EXPECT_NEAR(result.fit.corrected_M(readings_T(-1.0)[5]).norm(), 50e-6, 0.5e-6);
}

TEST(IronCalibration, ReducesTheModelWithTheCoverageAndSaysWhy) {
  CloudTruth truth;
  truth.correction = Vec3(1.05, 0.93, 1.1).asDiagonal();
  const IronCalibration half = calibrateIron(readings_T(0.1, truth), {});
  EXPECT_EQ(half.fit.model, IronModel::Diagonal);
  ASSERT_EQ(half.refusals.size(), 1u);
  EXPECT_THAT(half.refusals[0], HasSubstr("60 %"));
  // A part of the sphere has little information, and the stated uncertainty is correspondingly large.
  EXPECT_GT(half.fit.heading_error_rad, 5e-3);
}

TEST(IronCalibration, FitsTheOffsetAloneWhereTheFieldIsKnown) {
  IronCalibrationOptions options;
  CloudTruth ideal;
  ideal.correction = Mat3::Identity();
  const std::vector<Vec3> readings = readings_T(0.7, ideal);
  options.greatest_heading_error_rad = 0.3;
  options.field_strength_T = kField_T;
  const IronCalibration result = calibrateIron(readings, options);
  EXPECT_EQ(result.fit.model, IronModel::Offset);
  EXPECT_EQ(result.refusals.size(), 3u);
  EXPECT_LT((result.fit.hard_iron - kField_T * ideal.hard_iron).norm(), 0.5e-6);
  EXPECT_GT(result.fit.heading_error_rad, 0.02);
}

TEST(IronCalibration, RefusesAndSaysHowToMove) {
  const std::string refusal = refusalOf(readings_T(0.8));
  EXPECT_THAT(refusal, HasSubstr("cannot calibrate"));
  EXPECT_THAT(refusal, HasSubstr("% of the sphere"));
  EXPECT_THAT(refusal, HasSubstr("six sides"));
  EXPECT_THAT(refusal, HasSubstr("+x, -x, +y, -y, -z"));
  EXPECT_THAT(refusalOf(std::vector<Vec3>(10, Vec3::Ones())), HasSubstr("10 usable"));
}

TEST(IronCalibration, RefusesReadingsWithoutVolume) {
  std::vector<Vec3> circle;
  for (int i = 0; i < 300; ++i) circle.emplace_back(4e-5 * Vec3(std::cos(0.1 * i), std::sin(0.1 * i), 0.0));
  EXPECT_THAT(refusalOf(circle), HasSubstr("cannot calibrate"));
  EXPECT_THAT(refusalOf(std::vector<Vec3>(300, Vec3(1e-5, 2e-5, 3e-5))), HasSubstr("cannot calibrate"));
}

TEST(IronCalibration, KeepsTheOldOneWhereNothingElseIsLeft) {
  IronCalibrationOptions options;
  options.old.emplace();
  options.old->hard_iron = Vec3(1e-6, 2e-6, 3e-6);
  const IronCalibration result = calibrateIron(readings_T(0.8), options);
  EXPECT_EQ(result.fit.model, IronModel::Kept);
  EXPECT_EQ(result.fit.hard_iron, options.old->hard_iron);
}

TEST(IronCalibration, ToleratesOutliers) {
  std::vector<Vec3> readings = readings_T(-1.0);
  for (size_t i = 0; i < readings.size(); i += 7) readings[i] *= 1.4;
  const IronCalibration result = calibrateIron(readings, {});
  EXPECT_EQ(result.fit.model, IronModel::Full);
  EXPECT_NEAR(result.fit.rejected_share, 1.0 / 7.0, 0.02);
  EXPECT_LT((result.fit.hard_iron - kField_T * CloudTruth().hard_iron).norm(), 0.05e-6);
}

TEST(IronCalibration, RefusesNoise) {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal(0.0, 3e-5);
  std::vector<Vec3> noise;
  for (int i = 0; i < 500; ++i) noise.emplace_back(normal(engine), normal(engine), normal(engine));
  EXPECT_THAT(refusalOf(noise), HasSubstr("residual"));
}

TEST(SettleScale, CovarianceFollowsTheScale) {
  MagnetometerFit fit;
  fit.iron_correction = 2e4 * (Mat3() << 1.0, 0.1, 0.0, 0.1, 1.2, 0.0, 0.0, 0.0, 0.9).finished();
  fit.field_strength_T = 1.0;
  fit.covariance.topLeftCorner<6, 6>() =
      1e-4 * symmetricEntries(fit.iron_correction) * symmetricEntries(fit.iron_correction).transpose();
  MagnetometerFit known = fit;
  settleScale(45e-6, &known);
  EXPECT_NEAR(known.sigmas()[0], 0.01 * known.iron_correction(0, 0), 1e-9);
  // A pure scale error vanishes where the determinant is fixed.
  settleScale(std::nullopt, &fit);
  EXPECT_NEAR(fit.iron_correction.determinant(), 1.0, 1e-12);
  EXPECT_LT(fit.sigmas().head<6>().maxCoeff(), 1e-7);
}

}  // namespace
}  // namespace lodeline

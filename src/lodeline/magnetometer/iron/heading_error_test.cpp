#include "lodeline/magnetometer/iron/heading_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

constexpr double kDip_rad = 1.0;

MagnetometerFit ideal() {
  MagnetometerFit fit;
  fit.field_strength_T = 50e-6;
  return fit;
}

TEST(HeadingSigma, IsTheHardIronByTheHorizontalField) {
  MagnetometerFit fit = ideal();
  fit.covariance.diagonal().segment<3>(fit_parameter::kHardIron).setConstant(1e-14);  // 0.1 uT
  EXPECT_NEAR(headingSigma(fit, kDip_rad), 0.1e-6 / (50e-6 * std::cos(kDip_rad)), 1e-12);
}

TEST(HeadingSigma, CountsTheRotationAndNotTheScale) {
  MagnetometerFit fit = ideal();
  fit.covariance.diagonal().tail<3>().setConstant(1e-4);  // 0.01 rad
  EXPECT_NEAR(headingSigma(fit, kDip_rad), 0.01 / std::cos(kDip_rad), 1e-9);
  fit.covariance.setZero();
  fit.covariance.topLeftCorner<3, 3>().setConstant(1e-4);  // a common error of all scale factors
  EXPECT_NEAR(headingSigma(fit, kDip_rad), 0.0, 1e-9);
  fit.axes_sigma_rad = 0.01;
  EXPECT_NEAR(headingSigma(fit, kDip_rad), 0.01 / std::cos(kDip_rad), 1e-9);
}

TEST(CompareCalibrations, FindsNoDifferenceBetweenEqualOnes) {
  MagnetometerFit fit = ideal();
  fit.covariance.diagonal().setConstant(1e-14);
  const CalibrationDifference d = compareCalibrations(fit, fit, kDip_rad);
  EXPECT_NEAR(d.heading_rms_rad, 0.0, 1e-7);
  EXPECT_FALSE(d.significant);
  EXPECT_EQ(d.chi_square, 0.0);
}

TEST(CompareCalibrations, JudgesAMovedHardIron) {
  MagnetometerFit before = ideal();
  before.covariance.diagonal().segment<3>(fit_parameter::kHardIron).setConstant(0.5e-14);
  MagnetometerFit after = before;
  after.hard_iron = Vec3(1e-6, 0.0, 0.0);
  const CalibrationDifference d = compareCalibrations(before, after, kDip_rad);
  EXPECT_TRUE(d.significant);
  EXPECT_EQ(d.degrees_of_freedom, 3);
  EXPECT_NEAR(d.chi_square, 100.0, 1e-6);
  // 1 uT normal to 50 uT: a third of the squared components is along the field, and half of the rest is east.
  EXPECT_NEAR(d.heading_rms_rad, 0.02 * std::sqrt(1.0 / 3.0) / std::cos(kDip_rad), 2e-4);
  EXPECT_NEAR(d.heading_largest_rad, 0.02 / std::cos(kDip_rad), 1e-3);

  after.hard_iron = Vec3(0.1e-6, 0.0, 0.0);
  EXPECT_FALSE(compareCalibrations(before, after, kDip_rad).significant);
}

TEST(CompareCalibrations, SeesARotation) {
  MagnetometerFit before = ideal();
  before.body_from_magnetometer = so3::exp(Vec3(0.0, 0.0, 1.2));
  before.covariance.diagonal().tail<3>().setConstant(1e-6);
  MagnetometerFit after = before;
  after.body_from_magnetometer = so3::exp(Vec3(0.02, 0.0, 0.0)) * *before.body_from_magnetometer;
  const CalibrationDifference d = compareCalibrations(before, after, kDip_rad);
  ASSERT_TRUE(d.rotation_rad);
  EXPECT_NEAR(d.rotation_rad->x(), 0.02, 1e-9);
  EXPECT_TRUE(d.significant);
  EXPECT_NEAR(d.heading_largest_rad, 0.02 / std::cos(kDip_rad), 1e-3);
}

}  // namespace
}  // namespace lodeline

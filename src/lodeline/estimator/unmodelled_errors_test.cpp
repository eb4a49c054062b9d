#include "lodeline/estimator/unmodelled_errors.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

namespace lodeline {
namespace {

using Mat15 = Eigen::Matrix<double, 15, 15>;

Mat15 added(const EstimatorOptions& options, const EstimateSources& sources, const Vec3& position_W) {
  Mat15 covariance = Mat15::Zero();
  addUnmodelledErrors(options, sources, position_W, &covariance);
  return covariance;
}

const Vec3 kPosition(30.0, 40.0, -20.0);

TEST(UnmodelledErrors, OfOneCameraLieAlongTheWayFromTheOrigin) {
  const Mat15 covariance = added({}, {.is_scale_given = false}, kPosition);
  const Mat3 position = covariance.topLeftCorner<3, 3>();
  EXPECT_NEAR(kPosition.normalized().dot(position * kPosition.normalized()),
              std::pow(kOneCameraScaleSigma * kPosition.norm(), 2), 1e-12);
  EXPECT_NEAR((position * Vec3(40.0, -30.0, 0.0)).norm(), 0.0, 1e-12);
  EXPECT_EQ(covariance.bottomRightCorner(12, 12).norm(), 0.0);
  EXPECT_EQ(added({}, {.is_scale_given = false}, Vec3::Zero()).norm(), 0.0);
}

TEST(UnmodelledErrors, OfTheDensityAreOfTheHeightAlone) {
  EstimatorOptions options;
  Mat15 covariance = added(options, {.is_scale_given = true, .has_depth = true}, kPosition);
  EXPECT_NEAR(covariance(2, 2), std::pow(0.007 * 20.0, 2), 1e-12);
  covariance(2, 2) = 0.0;
  EXPECT_EQ(covariance.norm(), 0.0);
  options.depth.density_ratio_sigma = 0.001;
  EXPECT_NEAR(added(options, {.is_scale_given = true, .has_depth = true}, kPosition)(2, 2),
              std::pow(0.001 * 20.0, 2), 1e-12);
}

TEST(UnmodelledErrors, AreNoneOfTwoCamerasOrWhereTheCalibrationIsBelieved) {
  EstimatorOptions options;
  EXPECT_EQ(added(options, {.is_scale_given = true}, kPosition).norm(), 0.0);
  options.camera_calibration.enabled = false;
  EXPECT_EQ(added(options, {.is_scale_given = false, .has_depth = true}, kPosition).norm(), 0.0);
  EXPECT_EQ(unmodelledDensitySigma(options), 0.0);
}

}  // namespace
}  // namespace lodeline

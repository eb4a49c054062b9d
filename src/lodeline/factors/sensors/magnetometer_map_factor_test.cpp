#include "lodeline/factors/sensors/magnetometer_map_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <limits>
#include <random>

#include "lodeline/diagnostics.h"
#include "lodeline/factors/numeric_jacobian.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

using MapBlocks = std::vector<Eigen::VectorXd>;

const Rigid3 kMapPose(so3::exp(Vec3(0.3, -0.4, 2.0)), Vec3(3.0, -2.0, 1.0));
const Vec3 kMapped_M(9e-6, 17e-6, -52e-6);
constexpr double kMapHeading_rad = 0.04;

Mat3 mapCovariance() {
  Mat3 root = 0.4e-6 * Mat3::Identity();
  root(1, 0) = 0.2e-6;
  root(2, 1) = -0.3e-6;
  return root * root.transpose();
}

Vec3 readingAtTruth() {
  return kMapPose.rotation.conjugate() * (so3::exp(kMapHeading_rad * Vec3::UnitZ()) * kMapped_M);
}

MapBlocks blocksOf(const Rigid3& pose, double heading_rad) {
  return {poseVector(pose), Eigen::VectorXd::Constant(1, heading_rad)};
}

MagnetometerMapFactor factorOf(const Vec3& reading_B, const Quat& reference = kMapPose.rotation) {
  return MagnetometerMapFactor(reading_B, kMapped_M, mapCovariance(), reference);
}

Vec3 residualOf(const MagnetometerMapFactor& factor, const MapBlocks& blocks) {
  const double* pointers[] = {blocks[0].data(), blocks[1].data()};
  Vec3 residual;
  EXPECT_TRUE(factor.Evaluate(pointers, residual.data(), nullptr));
  return residual;
}

TEST(MagnetometerMapFactor, IsZeroAtTheTruth) {
  EXPECT_LT(residualOf(factorOf(readingAtTruth()), blocksOf(kMapPose, kMapHeading_rad)).norm(), 1e-9);
}

TEST(MagnetometerMapFactor, JacobiansAgreeWithNumericDifferentiation) {
  const Quat reference = so3::exp(Vec3(0.05, -0.08, 0.3)) * kMapPose.rotation;
  expectJacobiansMatch(factorOf(readingAtTruth() + Vec3(2e-6, -1e-6, 3e-6), reference),
                       blocksOf(kMapPose, -0.2));
}

TEST(MagnetometerMapFactor, IsWhitened) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const Mat3 root = mapCovariance().llt().matrixL();
  const MapBlocks truth = blocksOf(kMapPose, kMapHeading_rad);
  double sum = 0.0;
  constexpr int kCount = 2000;
  for (int i = 0; i < kCount; ++i) {
    const Vec3 error_W = root * Vec3(normal(random), normal(random), normal(random));
    sum +=
        residualOf(factorOf(readingAtTruth() + kMapPose.rotation.conjugate() * error_W), truth).squaredNorm();
  }
  EXPECT_NEAR(sum / kCount, 3.0, 0.2);
}

TEST(MagnetometerMapFactor, YawOfPosesAndMapTogetherChangesNothing) {
  const MagnetometerMapFactor factor = factorOf(readingAtTruth() + Vec3(1e-6, 2e-6, -1e-6));
  const Vec3 before = residualOf(factor, blocksOf(kMapPose, kMapHeading_rad));
  const double turn_rad = 0.3;
  const Rigid3 turned(so3::exp(turn_rad * Vec3::UnitZ()) * kMapPose.rotation, kMapPose.translation);
  const Vec3 after = residualOf(factor, blocksOf(turned, kMapHeading_rad + turn_rad));
  // The whitening stays in the axes of the construction; the cost without it is the same.
  const Mat3 root = mapCovariance().llt().matrixL();
  EXPECT_NEAR((root * before).norm(), (root * after).norm(), 1e-12);

  // With linearization points the sum of both derivatives is zero, wherever the values are.
  const Eigen::VectorXd first_pose = poseVector(kMapPose);
  const double first_heading = 0.1;
  const MagnetometerMapFactor fixed(readingAtTruth(), kMapped_M, mapCovariance(), kMapPose.rotation,
                                    first_pose.data(), &first_heading);
  const MapBlocks blocks = blocksOf(turned, 0.5);
  const double* pointers[] = {blocks[0].data(), blocks[1].data()};
  Eigen::Matrix<double, 3, kPoseSize, Eigen::RowMajor> by_pose;
  Vec3 residual, by_heading;
  double* jacobians[] = {by_pose.data(), by_heading.data()};
  ASSERT_TRUE(fixed.Evaluate(pointers, residual.data(), jacobians));
  EXPECT_LT((by_pose.col(5) + by_heading).norm(), 1e-9 * by_heading.norm());
}

TEST(MagnetometerMapFactor, InformsNeitherPositionNorTilt) {
  const MagnetometerMapFactor factor = factorOf(readingAtTruth());
  const MapBlocks blocks = blocksOf(kMapPose, kMapHeading_rad);
  const double* pointers[] = {blocks[0].data(), blocks[1].data()};
  Eigen::Matrix<double, 3, kPoseSize, Eigen::RowMajor> by_pose;
  Vec3 residual;
  double* jacobians[] = {by_pose.data(), nullptr};
  ASSERT_TRUE(factor.Evaluate(pointers, residual.data(), jacobians));
  EXPECT_EQ(by_pose.leftCols<3>().norm(), 0.0);
  EXPECT_LT(by_pose.middleCols<2>(3).norm(), 1e-9 * by_pose.col(5).norm());
}

TEST(MagnetometerMapFactor, RefusesWhatCannotBeWeighed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(factorOf(Vec3(nan, 0.0, 0.0)), InputError);
  EXPECT_THROW(MagnetometerMapFactor(readingAtTruth(), kMapped_M, Mat3::Zero(), kMapPose.rotation),
               InputError);
  EXPECT_THROW(
      MagnetometerMapFactor(readingAtTruth(), Vec3(0.0, nan, 0.0), mapCovariance(), kMapPose.rotation),
      InputError);
}

}  // namespace
}  // namespace lodeline

#include "lodeline/factors/sensors/magnetometer_field_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <random>

#include "lodeline/diagnostics.h"
#include "lodeline/factors/numeric_jacobian.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

using Blocks = std::vector<Eigen::VectorXd>;

const Rigid3 kPose(so3::exp(Vec3(0.3, -0.4, 2.0)), Vec3(3.0, -2.0, 1.0));
const Vec3 kField_W(1e-6, 24e-6, -38e-6);
const Vec3 kOffset_B(0.4e-6, -0.3e-6, 0.2e-6);
const Vec3 kDisturbance_W(2e-6, 1e-6, -1e-6);
const FieldNoise kNoise{0.2e-6, 1e-3, 3e-3};
const Mat3 kCarried = so3::exp(Vec3(0.02, -0.03, 0.05)).toRotationMatrix();

Vec3 meanOf(const Rigid3& pose, const Vec3& field_W) {
  return pose.rotation.conjugate() * field_W + kCarried * kOffset_B;
}

Blocks trueBlocks(bool disturbed) {
  Blocks blocks = {poseVector(kPose), kField_W, kOffset_B};
  if (disturbed) blocks.push_back(kDisturbance_W);
  return blocks;
}

MagnetometerFieldFactor makeFactor(bool disturbed, const Quat& reference = kPose.rotation) {
  const Vec3 field_W = disturbed ? Vec3(kField_W + kDisturbance_W) : kField_W;
  return MagnetometerFieldFactor(meanOf(kPose, field_W), kCarried, reference, field_W, kNoise, disturbed);
}

Vec3 residualOf(const MagnetometerFieldFactor& factor, const Blocks& blocks) {
  std::vector<const double*> pointers;
  for (const auto& block : blocks) pointers.push_back(block.data());
  Vec3 residual;
  EXPECT_TRUE(factor.Evaluate(pointers.data(), residual.data(), nullptr));
  return residual;
}

Eigen::Matrix<double, 3, kPoseSize, Eigen::RowMajor> poseJacobian(const MagnetometerFieldFactor& factor,
                                                                  const Blocks& blocks) {
  Eigen::Matrix<double, 3, kPoseSize, Eigen::RowMajor> jacobian;
  Vec3 residual;
  const double* pointers[] = {blocks[0].data(), blocks[1].data(), blocks[2].data()};
  double* jacobians[] = {jacobian.data(), nullptr, nullptr};
  EXPECT_TRUE(factor.Evaluate(pointers, residual.data(), jacobians));
  return jacobian;
}

Blocks turned(const Blocks& blocks, double yaw_rad) {
  const Rigid3 other_from_world(so3::exp(Vec3(0.0, 0.0, yaw_rad)), Vec3::Zero());
  Blocks result = blocks;
  result[0] = poseVector(other_from_world * poseFromBlock(blocks[0].data()));
  result[1] = other_from_world.rotation * Vec3(blocks[1]);
  return result;
}

TEST(MagnetometerFieldFactor, IsZeroAtTheTruth) {
  for (const bool disturbed : {false, true})
    EXPECT_LT(residualOf(makeFactor(disturbed), trueBlocks(disturbed)).norm(), 1e-9);
}

TEST(MagnetometerFieldFactor, JacobiansAgreeWithNumericDifferentiation) {
  // The reference attitude may be wrong by some degrees.
  const Quat reference = so3::exp(Vec3(0.05, -0.08, 0.3)) * kPose.rotation;
  for (const bool disturbed : {false, true}) {
    Blocks blocks = trueBlocks(disturbed);
    blocks[1] += Vec3(3e-6, -2e-6, 1e-6);
    expectJacobiansMatch(makeFactor(disturbed, reference), blocks);
  }
}

TEST(MagnetometerFieldFactor, ContainsTheFieldsOfCurrents) {
  const std::vector<double> currents_A = {12.0, -0.5};
  const Vec3 fields_B[2] = {Vec3(0.3e-6, -0.2e-6, 0.4e-6), Vec3(-2e-6, 1e-6, 3e-6)};
  for (const bool disturbed : {false, true}) {
    const Vec3 field_W = disturbed ? Vec3(kField_W + kDisturbance_W) : kField_W;
    const Vec3 mean_B =
        meanOf(kPose, field_W) + kCarried * (currents_A[0] * fields_B[0] + currents_A[1] * fields_B[1]);
    const MagnetometerFieldFactor factor(mean_B, kCarried, so3::exp(Vec3(0.05, -0.08, 0.3)) * kPose.rotation,
                                         field_W, kNoise, disturbed, nullptr, nullptr, currents_A);
    Blocks blocks = trueBlocks(disturbed);
    for (const Vec3& field_B : fields_B) blocks.push_back(field_B);
    const MagnetometerFieldFactor exact(mean_B, kCarried, kPose.rotation, field_W, kNoise, disturbed, nullptr,
                                        nullptr, currents_A);
    EXPECT_LT(residualOf(exact, blocks).norm(), 1e-9);
    expectJacobiansMatch(factor, blocks);
  }
}

TEST(MagnetometerFieldFactor, SeesHeadingButNeitherTiltNorPosition) {
  const MagnetometerFieldFactor factor = makeFactor(false);
  const auto jacobian = poseJacobian(factor, trueBlocks(false));
  EXPECT_EQ(jacobian.leftCols<3>().norm(), 0.0);
  EXPECT_LT(jacobian.middleCols<2>(3).norm(), 1e-9 * jacobian.col(5).norm());
  // The property also holds beyond first order: half a radian about a horizontal axis.
  for (const Vec3& axis : {Vec3(0.5, 0.0, 0.0), Vec3(-0.3, 0.4, 0.0)}) {
    Blocks blocks = trueBlocks(false);
    blocks[0] = poseVector(Rigid3(so3::exp(axis) * kPose.rotation, kPose.translation));
    EXPECT_LT(residualOf(factor, blocks).norm(), 1e-6);
  }
}

TEST(MagnetometerFieldFactor, TakesHeadingFromTheHorizontalFieldAlone) {
  // J_yaw^T e is the gradient of the cost with respect to heading. A residual in the vertical plane of the
  // field must not change it.
  const FieldNoise isotropic{0.2e-6, 0.0, 0.0};
  for (const Vec3& change_W : {Vec3(0.0, 0.0, 3e-6), Vec3(1e-7, 24e-7, 0.0)}) {
    const MagnetometerFieldFactor factor(meanOf(kPose, kField_W + change_W), kCarried, kPose.rotation,
                                         kField_W, isotropic, false, nullptr, kField_W.data());
    const Blocks blocks = trueBlocks(false);
    EXPECT_GT(residualOf(factor, blocks).norm(), 1.0);
    EXPECT_NEAR(poseJacobian(factor, blocks).col(5).dot(residualOf(factor, blocks)), 0.0, 1e-6);
  }
}

TEST(MagnetometerFieldFactor, WhitenedNoiseHasUnitCovariance) {
  constexpr int kRuns = 4000;
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  const auto gaussian = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  Mat3 squares = Mat3::Zero();
  for (int run = 0; run < kRuns; ++run) {
    const Vec3 rotation = kNoise.rotation_sigma_rad * gaussian();
    Vec3 tilt = kNoise.tilt_sigma_rad * gaussian();
    tilt.z() = 0.0;
    const Vec3 mean_B = so3::exp(kPose.rotation.conjugate() * rotation) * meanOf(kPose, kField_W) +
                        kNoise.sigma_T * gaussian();
    const MagnetometerFieldFactor factor(mean_B, kCarried, so3::exp(tilt) * kPose.rotation, kField_W, kNoise,
                                         false);
    const Vec3 e = residualOf(factor, trueBlocks(false));
    squares += e * e.transpose() / kRuns;
  }
  EXPECT_LT((squares - Mat3::Identity()).cwiseAbs().maxCoeff(), 4.0 * std::sqrt(2.0 / kRuns)) << squares;
}

TEST(MagnetometerFieldFactor, TurningTheWorldAboutGravityChangesNothing) {
  Blocks blocks = trueBlocks(false);
  blocks[1] += Vec3(3e-6, -2e-6, 1e-6);
  for (const double yaw_rad : {0.5, -2.0}) {
    const Blocks other = turned(blocks, yaw_rad);
    const MagnetometerFieldFactor factor(meanOf(kPose, kField_W), kCarried, kPose.rotation, kField_W, kNoise,
                                         false);
    const MagnetometerFieldFactor other_factor(meanOf(kPose, kField_W), kCarried,
                                               so3::exp(Vec3(0.0, 0.0, yaw_rad)) * kPose.rotation,
                                               so3::exp(Vec3(0.0, 0.0, yaw_rad)) * kField_W, kNoise, false);
    EXPECT_NEAR(residualOf(factor, blocks).norm(), residualOf(other_factor, other).norm(), 1e-9);
    // A rotation of the poses alone must change the residual.
    EXPECT_GT(residualOf(factor, {other[0], blocks[1], blocks[2]}).norm(), 10.0);
  }
}

// With linearization points, the yaw of the pose and that of the field cancel exactly at all values of the
// blocks.
TEST(MagnetometerFieldFactor, LinearizationPointsKeepTheYawOfTheWorldUnobservable) {
  const Eigen::VectorXd first_pose =
      poseVector(Rigid3(so3::exp(Vec3(0.01, 0.02, -0.03)) * kPose.rotation, Vec3::Zero()));
  const Vec3 first_field = kField_W + Vec3(2e-6, 1e-6, -1e-6);
  const MagnetometerFieldFactor factor(meanOf(kPose, kField_W), kCarried,
                                       poseFromBlock(first_pose.data()).rotation, kField_W, kNoise, false,
                                       first_pose.data(), first_field.data());
  const Blocks blocks = trueBlocks(false);
  Eigen::Matrix<double, 3, kPoseSize, Eigen::RowMajor> by_pose;
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> by_field;
  Vec3 residual;
  const double* pointers[] = {blocks[0].data(), blocks[1].data(), blocks[2].data()};
  double* jacobians[] = {by_pose.data(), by_field.data(), nullptr};
  ASSERT_TRUE(factor.Evaluate(pointers, residual.data(), jacobians));
  const Vec3 effect = by_pose.col(5) + by_field * Vec3::UnitZ().cross(first_field);
  EXPECT_LT(effect.norm(), 1e-9 * by_pose.col(5).norm());
}

TEST(MagnetometerFieldFactor, RefusesWhatCannotBeWeighed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto make = [](const Vec3& mean, const FieldNoise& noise) {
    return MagnetometerFieldFactor(mean, kCarried, kPose.rotation, kField_W, noise, false);
  };
  EXPECT_THROW(make(Vec3(nan, 0.0, 0.0), kNoise), InputError);
  EXPECT_THROW(make(kField_W, FieldNoise{0.0, 0.0, 0.0}), InputError);
  EXPECT_THROW(make(kField_W, FieldNoise{nan, 0.0, 0.0}), InputError);
  // A zero field has no heading, so its Jacobian by the pose is zero.
  const MagnetometerFieldFactor nothing(Vec3::Zero(), kCarried, kPose.rotation, Vec3::Zero(), kNoise, false);
  EXPECT_EQ(poseJacobian(nothing, {poseVector(kPose), Vec3::Zero(), Vec3::Zero()}).norm(), 0.0);
}

}  // namespace
}  // namespace lodeline

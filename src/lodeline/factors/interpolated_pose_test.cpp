#include "lodeline/factors/interpolated_pose.h"

#include <gtest/gtest.h>

#include "lodeline/factors/reprojection_scene.h"

namespace lodeline {
namespace {

class InterpolatedPoseTest : public testing::Test {
 protected:
  // A curved path with rotation, and the outer poses after a correction by a solver.
  Rigid3 before_{so3::exp(Vec3(0.1, 0.0, 0.9)), Vec3(1.1, -2.0, 0.5)};
  Rigid3 after_{so3::exp(Vec3(0.4, 0.2, 1.2)), Vec3(1.4, -1.7, 0.7)};
  ReprojectionScene scene_;
  PoseInterpolation interpolation_{before_, scene_.world_from_target, after_, 0.4};
  Rigid3 moved_before_{so3::exp(Vec3(0.02, -0.03, 0.01)) * before_.rotation,
                       before_.translation + Vec3(0.02, 0.01, -0.01)};
  Rigid3 moved_after_{so3::exp(Vec3(-0.02, 0.01, 0.03)) * after_.rotation,
                      after_.translation + Vec3(-0.01, 0.03, 0.02)};

  std::unique_ptr<ReprojectionFactor> reprojection(const double* first_target = nullptr) const {
    const Rigid3 body_from_camera(so3::exp(Vec3(0.1, -0.2, 0.05)), Vec3(0.05, 0.02, -0.01));
    return std::make_unique<ReprojectionFactor>(scene_.measurement(Vec3(0.3, -0.2, 2.4)), scene_.base(),
                                                body_from_camera, body_from_camera, nullptr, first_target);
  }
};

double distance(const Rigid3& a, const Rigid3& b) { return perturbationBetween(a, b).norm(); }

TEST_F(InterpolatedPoseTest, IsThePoseItWasMadeOf) {
  EXPECT_LT(distance(interpolation_.pose(before_, after_), scene_.world_from_target), 1e-12);
}

TEST_F(InterpolatedPoseTest, IsTakenAlongByARigidMotionOfBoth) {
  const Rigid3 motion(so3::exp(Vec3(0.3, -1.0, 0.7)), Vec3(5.0, -3.0, 2.0));
  EXPECT_LT(
      distance(interpolation_.pose(motion * before_, motion * after_), motion * scene_.world_from_target),
      1e-12);
}

TEST_F(InterpolatedPoseTest, SharesOutWhatTheEndsDisagreeBy) {
  Rigid3 later = after_;
  later.translation += Vec3(0.1, 0.0, 0.0);
  later.rotation = so3::exp(Vec3(0.0, 0.0, 0.05)) * later.rotation;
  const Eigen::Matrix<double, 6, 1> moved =
      perturbationBetween(scene_.world_from_target, interpolation_.pose(before_, later));
  EXPECT_LT((moved - (Eigen::Matrix<double, 6, 1>() << 0.04, 0, 0, 0, 0, 0.02).finished()).norm(), 1e-12);
}

TEST_F(InterpolatedPoseTest, HasTheDerivativesOfItsPose) {
  const auto by = interpolation_.derivatives(moved_before_, moved_after_);
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 6; ++i) {
    const Eigen::Matrix<double, 6, 1> step = kStep * Eigen::Matrix<double, 6, 1>::Unit(i);
    const auto derivative = [&](const Rigid3& b_low, const Rigid3& a_low, const Rigid3& b_high,
                                const Rigid3& a_high) -> Eigen::Matrix<double, 6, 1> {
      return perturbationBetween(interpolation_.pose(b_low, a_low), interpolation_.pose(b_high, a_high)) /
             (2.0 * kStep);
    };
    const Eigen::Matrix<double, 6, 1> by_before = derivative(perturbed(moved_before_, -step), moved_after_,
                                                             perturbed(moved_before_, step), moved_after_);
    const Eigen::Matrix<double, 6, 1> by_after = derivative(moved_before_, perturbed(moved_after_, -step),
                                                            moved_before_, perturbed(moved_after_, step));
    EXPECT_LT((by.by_before.col(i) - by_before).norm(), 1e-8) << "before, " << i;
    EXPECT_LT((by.by_after.col(i) - by_after).norm(), 1e-8) << "after, " << i;
  }
}

TEST_F(InterpolatedPoseTest, GivesAFactorTheJacobianOfItsResidual) {
  expectJacobiansMatch(InterpolatedPoseFactor(reprojection(), 1, interpolation_),
                       {poseVector(scene_.world_from_host), poseVector(moved_before_), scene_.landmark(),
                        poseVector(moved_after_)});
}

TEST_F(InterpolatedPoseTest, GivesAFactorTheResidualAtThatPose) {
  const InterpolatedPoseFactor between(reprojection(), 1, interpolation_);
  const Vec2 expected = evaluate(*reprojection(), {poseVector(scene_.world_from_host),
                                                   poseVector(scene_.world_from_target), scene_.landmark()});
  const Vec2 residual = evaluate(between, {poseVector(scene_.world_from_host), poseVector(before_),
                                           scene_.landmark(), poseVector(after_)});
  EXPECT_GT(expected.norm(), 1.0);
  EXPECT_LT((residual - expected).norm(), 1e-9 * expected.norm());
}

// The Jacobian is that at the linearization points, whatever the current poses are.
TEST_F(InterpolatedPoseTest, TakesItsJacobianAtLinearizationPoints) {
  const Eigen::VectorXd host = poseVector(scene_.world_from_host), landmark = scene_.landmark();
  const Eigen::VectorXd before = poseVector(moved_before_), after = poseVector(moved_after_);
  const Eigen::VectorXd between = poseVector(interpolation_.pose(moved_before_, moved_after_));
  const auto jacobianOf = [&](const InterpolatedPoseFactor& factor, const Rigid3& b, const Rigid3& a) {
    const Eigen::VectorXd block_before = poseVector(b), block_after = poseVector(a);
    const double* blocks[] = {host.data(), block_before.data(), landmark.data(), block_after.data()};
    Vec2 residual;
    Eigen::Matrix<double, 2, kPoseSize, Eigen::RowMajor> by_before, by_after;
    double* jacobians[] = {nullptr, by_before.data(), nullptr, by_after.data()};
    EXPECT_TRUE(factor.Evaluate(blocks, residual.data(), jacobians));
    Eigen::Matrix<double, 2, 2 * kPoseSize> both;
    both << by_before, by_after;
    return both;
  };
  const InterpolatedPoseFactor held(reprojection(between.data()), 1, interpolation_, before.data(),
                                    after.data());
  const InterpolatedPoseFactor present(reprojection(), 1, interpolation_);
  const auto expected = jacobianOf(present, moved_before_, moved_after_);
  EXPECT_LT((jacobianOf(held, before_, after_) - expected).norm(), 1e-9 * expected.norm());
  EXPECT_GT((jacobianOf(present, before_, after_) - expected).norm(), 1e-3 * expected.norm());
}

}  // namespace
}  // namespace lodeline

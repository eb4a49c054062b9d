#include "lodeline/factors/interpolated_pose.h"

#include <gtest/gtest.h>

#include <array>

#include "lodeline/factors/reprojection_scene.h"

namespace lodeline {
namespace {

class InterpolatedPoseTest : public testing::Test {
 protected:
  // A turn with a swerve, and the later poses as a solver might have moved them.
  Rigid3 before_{so3::exp(Vec3(0.1, 0.0, 0.9)), Vec3(1.1, -2.0, 0.5)};
  Rigid3 after_{so3::exp(Vec3(0.4, 0.2, 1.2)), Vec3(1.4, -1.7, 0.7)};
  ReprojectionScene scene_;
  Interval interval_{Vec3(0.0, 0.0, -9.81), 0.8, {Vec3(0.02, -0.05, 0.03), 0.001 * SensorAxes::Ones()}};
  PoseInterpolation interpolation_{before_, scene_.world_from_target, after_, 0.4, interval_};
  AccelerometerCalibration same_ = interval_.accelerometer;
  AccelerometerCalibration other_{Vec3(0.3, -0.2, 0.15), SensorAxes::LinSpaced(-0.01, 0.02)};
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

Eigen::VectorXd motionVector(const AccelerometerCalibration& accelerometer) {
  Eigen::VectorXd motion = Eigen::VectorXd::Zero(kMotionSize);
  motion.tail<3>() = accelerometer.bias_B;
  return motion;
}

double distance(const Rigid3& a, const Rigid3& b) { return perturbationBetween(a, b).norm(); }

TEST_F(InterpolatedPoseTest, IsThePoseItWasMadeOf) {
  EXPECT_LT(distance(interpolation_.pose(before_, after_, same_), scene_.world_from_target), 1e-12);
}

TEST_F(InterpolatedPoseTest, IsTakenAlongByAShiftAndATurnAboutGravity) {
  const Rigid3 motion(so3::exp(Vec3(0.0, 0.0, 0.7)), Vec3(5.0, -3.0, 2.0));
  EXPECT_LT(distance(interpolation_.pose(motion * before_, motion * after_, same_),
                     motion * scene_.world_from_target),
            1e-12);
}

// A body that does not turn, under a constant force: where attitude, bias and axes turn out to be others, so
// does the acceleration, and the way between the ends is that of a body with this one. To first order in the
// axes, which are off by 2 % here.
TEST_F(InterpolatedPoseTest, IsWhereTheForcesThatWereReadTookTheBody) {
  const Vec3 reading_B(0.4, -0.3, 9.6);
  const double share = 0.4, now_s = share * interval_.elapsed_s;
  const auto way = [&](const Quat& world_from_body, const AccelerometerCalibration& accelerometer,
                       const Vec3& start_W, const Vec3& end_W) {
    const Mat3 axes = Mat3::Identity() + Eigen::Map<const Mat3>(accelerometer.axes.data());
    const Vec3 acceleration_W =
        world_from_body * Vec3(axes * (reading_B - accelerometer.bias_B)) + interval_.gravity_W;
    const double all_s = interval_.elapsed_s;
    const Vec3 velocity_W = (end_W - start_W) / all_s - 0.5 * all_s * acceleration_W;
    return std::array{
        Rigid3(world_from_body, start_W),
        Rigid3(world_from_body, start_W + now_s * velocity_W + 0.5 * now_s * now_s * acceleration_W),
        Rigid3(world_from_body, end_W)};
  };
  const auto as_known = way(before_.rotation, same_, Vec3(1.0, 2.0, 3.0), Vec3(1.3, 2.1, 2.9));
  const PoseInterpolation interpolation(as_known[0], as_known[1], as_known[2], share, interval_);
  const Quat turned = so3::exp(Vec3(0.05, -0.08, 0.3)) * before_.rotation;
  const auto as_found = way(turned, other_, Vec3(0.9, 2.2, 3.1), Vec3(1.4, 2.3, 2.8));
  EXPECT_LT(distance(interpolation.pose(as_found[0], as_found[2], other_), as_found[1]), 5e-4);
  const AccelerometerCalibration of_axes{same_.bias_B, other_.axes}, of_bias{other_.bias_B, same_.axes};
  for (const auto& half : {of_axes, of_bias})
    EXPECT_GT(distance(interpolation.pose(as_found[0], as_found[2], half), as_found[1]), 3e-3);
}

TEST_F(InterpolatedPoseTest, SharesOutWhatTheEndsDisagreeBy) {
  Rigid3 later = after_;
  later.translation += Vec3(0.1, 0.0, 0.0);
  later.rotation = so3::exp(Vec3(0.0, 0.0, 0.05)) * later.rotation;
  const Eigen::Matrix<double, 6, 1> moved =
      perturbationBetween(scene_.world_from_target, interpolation_.pose(before_, later, same_));
  EXPECT_LT((moved - (Eigen::Matrix<double, 6, 1>() << 0.04, 0, 0, 0, 0, 0.02).finished()).norm(), 1e-12);
}

TEST_F(InterpolatedPoseTest, HasTheDerivativesOfItsPose) {
  const auto by = interpolation_.derivatives(moved_before_, moved_after_, other_);
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 6; ++i) {
    const Eigen::Matrix<double, 6, 1> step = kStep * Eigen::Matrix<double, 6, 1>::Unit(i);
    const auto derivative = [&](const Rigid3& b_low, const Rigid3& a_low, const Rigid3& b_high,
                                const Rigid3& a_high) -> Eigen::Matrix<double, 6, 1> {
      return perturbationBetween(interpolation_.pose(b_low, a_low, other_),
                                 interpolation_.pose(b_high, a_high, other_)) /
             (2.0 * kStep);
    };
    const Eigen::Matrix<double, 6, 1> by_before = derivative(perturbed(moved_before_, -step), moved_after_,
                                                             perturbed(moved_before_, step), moved_after_);
    const Eigen::Matrix<double, 6, 1> by_after = derivative(moved_before_, perturbed(moved_after_, -step),
                                                            moved_before_, perturbed(moved_after_, step));
    EXPECT_LT((by.by_before.col(i) - by_before).norm(), 1e-8) << "before, " << i;
    EXPECT_LT((by.by_after.col(i) - by_after).norm(), 1e-8) << "after, " << i;
  }
  const auto moved = [&](const Vec3& bias_B, const SensorAxes& axes) {
    return interpolation_.pose(moved_before_, moved_after_, {other_.bias_B + bias_B, other_.axes + axes})
        .translation;
  };
  for (int i = 0; i < 3; ++i) {
    const Vec3 step = kStep * Vec3::Unit(i);
    const Vec3 both_ways = moved(step, SensorAxes::Zero()) - moved(-step, SensorAxes::Zero());
    EXPECT_LT((by.by_bias.col(i) - both_ways / (2.0 * kStep)).norm(), 1e-8) << "bias, " << i;
  }
  for (int i = 0; i < 9; ++i) {
    const SensorAxes step = kStep * SensorAxes::Unit(i);
    const Vec3 both_ways = moved(Vec3::Zero(), step) - moved(Vec3::Zero(), -step);
    EXPECT_LT((by.by_axes.col(i) - both_ways / (2.0 * kStep)).norm(), 1e-8) << "axes, " << i;
  }
}

TEST_F(InterpolatedPoseTest, GivesAFactorTheJacobianOfItsResidual) {
  expectJacobiansMatch(InterpolatedPoseFactor(reprojection(), 1, interpolation_, true),
                       {poseVector(scene_.world_from_host), poseVector(moved_before_), scene_.landmark(),
                        poseVector(moved_after_), motionVector(other_), other_.axes});
}

TEST_F(InterpolatedPoseTest, GivesAFactorTheResidualAtThatPose) {
  const InterpolatedPoseFactor between(reprojection(), 1, interpolation_, true);
  const Vec2 expected = evaluate(*reprojection(), {poseVector(scene_.world_from_host),
                                                   poseVector(scene_.world_from_target), scene_.landmark()});
  const Vec2 residual =
      evaluate(between, {poseVector(scene_.world_from_host), poseVector(before_), scene_.landmark(),
                         poseVector(after_), motionVector(same_), same_.axes});
  EXPECT_GT(expected.norm(), 1.0);
  EXPECT_LT((residual - expected).norm(), 1e-9 * expected.norm());
}

// Wherever the poses are now, the Jacobian is that of the poses' first estimates.
TEST_F(InterpolatedPoseTest, TakesItsJacobianAtFirstEstimates) {
  const Eigen::VectorXd host = poseVector(scene_.world_from_host), landmark = scene_.landmark();
  const Eigen::VectorXd before = poseVector(moved_before_), after = poseVector(moved_after_);
  const Eigen::VectorXd between = poseVector(interpolation_.pose(moved_before_, moved_after_, other_));
  const Eigen::VectorXd motion = motionVector(other_);
  const auto jacobianOf = [&](const InterpolatedPoseFactor& factor, const Rigid3& b, const Rigid3& a,
                              const AccelerometerCalibration& accelerometer) {
    const Eigen::VectorXd block_before = poseVector(b), block_after = poseVector(a);
    const Eigen::VectorXd block_motion = motionVector(accelerometer);
    const double* blocks[] = {host.data(),        block_before.data(), landmark.data(),
                              block_after.data(), block_motion.data(), accelerometer.axes.data()};
    Vec2 residual;
    Eigen::Matrix<double, 2, kPoseSize, Eigen::RowMajor> by_before, by_after;
    double* jacobians[] = {nullptr, by_before.data(), nullptr, by_after.data(), nullptr, nullptr};
    EXPECT_TRUE(factor.Evaluate(blocks, residual.data(), jacobians));
    Eigen::Matrix<double, 2, 2 * kPoseSize> both;
    both << by_before, by_after;
    return both;
  };
  const InterpolatedPoseFactor held(reprojection(between.data()), 1, interpolation_, true,
                                    {before.data(), after.data(), motion.data(), other_.axes.data()});
  const InterpolatedPoseFactor present(reprojection(), 1, interpolation_, true);
  const auto expected = jacobianOf(present, moved_before_, moved_after_, other_);
  EXPECT_LT((jacobianOf(held, before_, after_, same_) - expected).norm(), 1e-9 * expected.norm());
  EXPECT_GT((jacobianOf(present, before_, after_, same_) - expected).norm(), 1e-3 * expected.norm());
}

}  // namespace
}  // namespace lodeline

#include "lodeline/factors/reprojection_factor.h"

#include <gtest/gtest.h>

#include <random>

#include "lodeline/factors/reprojection_scene.h"

namespace lodeline {
namespace {

/// A landmark observed from two body poses with different extrinsics.
struct Scene : ReprojectionScene {
  Rigid3 body_from_host_camera{so3::exp(Vec3(0.1, -1.5, 0.2)), Vec3(-0.02, -0.06, 0.01)};
  Rigid3 body_from_target_camera{so3::exp(Vec3(0.12, -1.48, 0.22)), Vec3(-0.02, 0.05, 0.02)};

  Vec3 pointInTarget() const {
    const Vec3 point_W = world_from_host * (body_from_host_camera * point_host_C);
    return body_from_target_camera.inverse() * (world_from_target.inverse() * point_W);
  }
  ReprojectionFactor factor(const DirectionMeasurement& m, const double* host_first = nullptr,
                            const double* target_first = nullptr) const {
    return {m, base(), body_from_host_camera, body_from_target_camera, host_first, target_first};
  }
  std::vector<Eigen::VectorXd> parameters() const {
    return {poseVector(world_from_host), poseVector(world_from_target), landmark()};
  }
};

TEST(ReprojectionFactor, IsZeroAtTruth) {
  const Scene scene;
  EXPECT_LT(evaluate(scene.factor(scene.measurement(scene.pointInTarget())), scene.parameters()).norm(),
            1e-10);
}

TEST(ReprojectionFactor, JacobiansMatchNumericDifferentiation) {
  Scene scene;
  const DirectionMeasurement measurement = scene.measurement(scene.pointInTarget() + Vec3(0.01, -0.02, 0.0));
  expectJacobiansMatch(scene.factor(measurement), scene.parameters());
  auto at_infinity = scene.parameters();
  at_infinity[2][2] = 0.0;
  expectJacobiansMatch(scene.factor(measurement), at_infinity);
}

TEST(ReprojectionFactor, ResidualIsThePixelErrorOverSigma) {
  const Scene scene;
  const Vec3 point_C = scene.pointInTarget();
  const Vec2 pixel = *scene.camera->project(point_C);
  const Vec2 noise_px(0.31, -0.22);
  const Vec3 seen = *scene.camera->unproject(pixel + noise_px);
  const Vec2 residual = evaluate(scene.factor(scene.measurement(seen, 0.5)), scene.parameters());
  EXPECT_LT((residual + noise_px / 0.5).norm(), 2e-6);
}

TEST(ReprojectionFactor, IsWhitened) {
  const Scene scene;
  const Vec2 pixel = *scene.camera->project(scene.pointInTarget());
  std::mt19937 generator(7);
  std::normal_distribution<double> normal(0.0, 0.5);
  constexpr int kRuns = 2000;
  double chi_squared = 0.0;
  for (int i = 0; i < kRuns; ++i) {
    const Vec3 seen = *scene.camera->unproject(pixel + Vec2(normal(generator), normal(generator)));
    chi_squared += evaluate(scene.factor(scene.measurement(seen, 0.5)), scene.parameters()).squaredNorm();
  }
  // Mean of 2000 chi-squared variables of 2 degrees: 2 +- 0.045.
  EXPECT_NEAR(chi_squared / kRuns, 2.0, 0.18);
}

TEST(ReprojectionFactor, IsInvariantUnderAnyMotionOfTheWorld) {
  Scene scene;
  const auto factor = scene.factor(scene.measurement(scene.pointInTarget() + Vec3(0.05, 0.0, 0.0)));
  const Vec2 before = evaluate(factor, scene.parameters());
  scene.moveWorld();
  EXPECT_LT((evaluate(factor, scene.parameters()) - before).norm(), 1e-9);
}

TEST(ReprojectionFactor, LinearizationPointsKeepTranslationAndYawUnobservable) {
  Scene scene;
  // Linearization points that differ from the current poses, each by another perturbation.
  const Eigen::VectorXd host_first = poseVector(
      perturbed(scene.world_from_host,
                (Eigen::Matrix<double, 6, 1>() << 0.02, 0.01, -0.03, 0.01, 0.02, -0.01).finished()));
  const Eigen::VectorXd target_first = poseVector(
      perturbed(scene.world_from_target,
                (Eigen::Matrix<double, 6, 1>() << -0.01, 0.03, 0.02, -0.02, 0.01, 0.015).finished()));
  const auto factor =
      scene.factor(scene.measurement(scene.pointInTarget()), host_first.data(), target_first.data());
  using RowMajor = Eigen::Matrix<double, 2, 7, Eigen::RowMajor>;
  RowMajor host;
  RowMajor target;
  double* jacobians[3] = {host.data(), target.data(), nullptr};
  const auto parameters = scene.parameters();
  const double* pointers[3] = {parameters[0].data(), parameters[1].data(), parameters[2].data()};
  Vec2 residual;
  ASSERT_TRUE(factor.Evaluate(pointers, residual.data(), jacobians));
  EXPECT_LT((host.leftCols<3>() + target.leftCols<3>()).norm(), 1e-9);
  const auto yaw = [](const Eigen::VectorXd& pose) {
    Eigen::Matrix<double, 6, 1> direction;
    direction << Vec3::UnitZ().cross(Vec3(pose.head<3>())), Vec3::UnitZ();
    return direction;
  };
  EXPECT_LT((host.leftCols<6>() * yaw(host_first) + target.leftCols<6>() * yaw(target_first)).norm(), 1e-9);
  EXPECT_GT((host.leftCols<6>() * yaw(parameters[0]) + target.leftCols<6>() * yaw(parameters[1])).norm(),
            1e-2);
}

TEST(ReprojectionFactor, APointBehindTheCameraIsAConstantOutlier) {
  Scene scene;
  const auto factor = scene.factor(scene.measurement(-scene.pointInTarget()));
  std::vector<Eigen::VectorXd> parameters = scene.parameters();
  const double* pointers[3] = {parameters[0].data(), parameters[1].data(), parameters[2].data()};
  Eigen::Matrix<double, 2, 7, Eigen::RowMajor> host;
  double* jacobians[3] = {host.data(), nullptr, nullptr};
  Vec2 residual;
  ASSERT_TRUE(factor.Evaluate(pointers, residual.data(), jacobians));
  EXPECT_GT(residual.norm(), 1e3);
  EXPECT_EQ(host.norm(), 0.0);
}

TEST(HostReprojectionFactor, AgreesWithTheGeneralFactorAndItsNumericJacobian) {
  Scene scene;
  scene.world_from_target = scene.world_from_host;
  const DirectionMeasurement measurement = scene.measurement(scene.pointInTarget() + Vec3(0.01, 0.01, 0.0));
  const HostReprojectionFactor host_factor(
      measurement, scene.base(), scene.body_from_target_camera.inverse() * scene.body_from_host_camera);
  const Vec2 general = evaluate(scene.factor(measurement), scene.parameters());
  EXPECT_LT((evaluate(host_factor, {scene.landmark()}) - general).norm(), 1e-10);
  expectJacobiansMatch(host_factor, {scene.landmark()});
}

}  // namespace
}  // namespace lodeline

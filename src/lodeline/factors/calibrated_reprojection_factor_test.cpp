#include "lodeline/factors/calibrated_reprojection_factor.h"

#include <gtest/gtest.h>

#include "lodeline/factors/reprojection_scene.h"

namespace lodeline {
namespace {

/// A landmark observed from two moving bodies, with calibration files that are wrong by known corrections.
struct Scene : ReprojectionScene {
  Rigid3 body_from_camera0{so3::exp(Vec3(0.1, -1.5, 0.2)), Vec3(-0.02, -0.06, 0.01)};
  Rigid3 camera0_from_camera1{so3::exp(Vec3(0.01, -0.02, 0.005)), Vec3(0.11, 0.002, -0.001)};
  ImageMotion host_motion{Vec3(0.3, -0.1, 0.05), Vec3(0.2, -0.4, 0.3)};
  ImageMotion target_motion{Vec3(0.25, 0.1, -0.02), Vec3(-0.1, 0.5, 0.2)};
  Eigen::VectorXd camera0 = (Eigen::VectorXd(6) << 0.01, -0.015, 0.008, 0.004, -0.01, 0.006).finished();
  Eigen::VectorXd camera1 = (Eigen::VectorXd(6) << -0.003, 0.002, 0.004, 5e-4, -3e-4, 2e-4).finished();
  Eigen::VectorXd time_offset = Eigen::VectorXd::Constant(1, 0.008);

  Rigid3 worldFromTrueCamera(const Rigid3& world_from_body, const ImageMotion& motion, bool further) const {
    const Rigid3 world_from_camera0 = motion.poseAfter(world_from_body, time_offset[0]) *
                                      correctedExtrinsics(body_from_camera0, camera0.data());
    if (!further) return world_from_camera0;
    return world_from_camera0 * correctedExtrinsics(camera0_from_camera1, camera1.data());
  }
  DirectionMeasurement seenFrom(const Rigid3& world_from_body, const ImageMotion& motion, bool further,
                                const Vec3& error_C = Vec3::Zero()) const {
    const Vec3 point_W = worldFromTrueCamera(world_from_host, host_motion, false) * point_host_C;
    const Vec3 point_C = worldFromTrueCamera(world_from_body, motion, further).inverse() * point_W;
    return measurement(point_C + error_C);
  }
  CameraPlacement placement(bool further) const {
    return {body_from_camera0, further ? std::optional<Rigid3>(camera0_from_camera1) : std::nullopt};
  }
  CalibratedReprojectionFactor factor(bool further, const Vec3& error_C = Vec3::Zero(),
                                      const CalibratedLinearizationPoints& first = {}) const {
    return {seenFrom(world_from_target, target_motion, further, error_C),
            base(),
            placement(further),
            host_motion,
            target_motion,
            first};
  }
  std::vector<Eigen::VectorXd> parameters(bool further) const {
    std::vector<Eigen::VectorXd> blocks{poseVector(world_from_host), poseVector(world_from_target),
                                        landmark(), camera0, time_offset};
    if (further) blocks.push_back(camera1);
    return blocks;
  }
};

class CalibratedReprojection : public testing::TestWithParam<bool> {};

TEST_P(CalibratedReprojection, IsZeroAtTruthAndOnlyThere) {
  const Scene scene;
  auto parameters = scene.parameters(GetParam());
  EXPECT_LT(evaluate(scene.factor(GetParam()), parameters).norm(), 1e-9);
  for (size_t block = 3; block < parameters.size(); ++block) {
    auto uncorrected = parameters;
    uncorrected[block].setZero();
    EXPECT_GT(evaluate(scene.factor(GetParam()), uncorrected).norm(), 0.1) << block;
  }
}

TEST_P(CalibratedReprojection, JacobiansMatchNumericDifferentiation) {
  const Scene scene;
  const Vec3 error_C(0.01, -0.02, 0.0);
  expectJacobiansMatch(scene.factor(GetParam(), error_C), scene.parameters(GetParam()));
  auto at_infinity = scene.parameters(GetParam());
  at_infinity[2][2] = 0.0;
  expectJacobiansMatch(scene.factor(GetParam(), error_C), at_infinity);
}

TEST_P(CalibratedReprojection, TakesItsJacobianAtTheLinearizationPoints) {
  const Scene scene;
  const auto first = scene.parameters(GetParam());
  auto current = first;
  for (size_t b = 0; b < current.size(); ++b) {
    if (b != 2) current[b].head(1).array() += 0.01;
  }
  const CalibratedLinearizationPoints at{first[0].data(), first[1].data(), first[3].data(), first[4].data(),
                                         GetParam() ? first[5].data() : nullptr};
  const auto jacobian = [&](const ceres::CostFunction& factor, const std::vector<Eigen::VectorXd>& blocks) {
    std::vector<const double*> pointers;
    std::vector<Eigen::VectorXd> jacobians;
    std::vector<double*> targets;
    for (const auto& block : blocks) {
      pointers.push_back(block.data());
      jacobians.push_back(Eigen::VectorXd::Zero(2 * block.size()));
    }
    for (auto& target : jacobians) targets.push_back(target.data());
    Vec2 residual;
    factor.Evaluate(pointers.data(), residual.data(), targets.data());
    Eigen::VectorXd all(0);
    for (const auto& part : jacobians) {
      Eigen::VectorXd longer(all.size() + part.size());
      longer << all, part;
      all = longer;
    }
    return all;
  };
  const Eigen::VectorXd expected = jacobian(scene.factor(GetParam()), first);
  EXPECT_LT((jacobian(scene.factor(GetParam(), Vec3::Zero(), at), current) - expected).norm(),
            1e-9 * expected.norm());
  EXPECT_GT((jacobian(scene.factor(GetParam()), current) - expected).norm(), 1e-4 * expected.norm());
}

// With a correct calibration file and no time offset, the factor equals the plain one.
TEST_P(CalibratedReprojection, AgreesWithTheUncalibratedFactorAtZero) {
  const Scene scene;
  auto parameters = scene.parameters(GetParam());
  for (size_t block = 3; block < parameters.size(); ++block) parameters[block].setZero();
  const DirectionMeasurement measurement =
      scene.seenFrom(scene.world_from_target, scene.target_motion, GetParam());
  const Rigid3 body_from_target =
      GetParam() ? scene.body_from_camera0 * scene.camera0_from_camera1 : scene.body_from_camera0;
  const ReprojectionFactor plain(measurement, scene.base(), scene.body_from_camera0, body_from_target,
                                 nullptr, nullptr);
  const Vec2 expected = evaluate(plain, {parameters[0], parameters[1], parameters[2]});
  EXPECT_GT(expected.norm(), 1.0);
  EXPECT_LT((evaluate(scene.factor(GetParam()), parameters) - expected).norm(), 1e-9 * expected.norm());
}

INSTANTIATE_TEST_SUITE_P(Cameras, CalibratedReprojection, testing::Bool(),
                         [](const auto& info) { return info.param ? "Further" : "First"; });

TEST(CalibratedStereoFactor, IsZeroAtTruthWithMatchingJacobians) {
  const Scene scene;
  const DirectionMeasurement measurement = scene.seenFrom(scene.world_from_host, scene.host_motion, true);
  const CalibratedStereoFactor factor(measurement, scene.base(), scene.camera0_from_camera1);
  EXPECT_LT(evaluate(factor, {scene.landmark(), scene.camera1}).norm(), 1e-9);
  EXPECT_GT(evaluate(factor, {scene.landmark(), Eigen::VectorXd::Zero(6)}).norm(), 0.5);
  expectJacobiansMatch(factor, {scene.landmark() + 0.01 * Vec3::Ones(), scene.camera1});
}

// Points behind the target camera must have zero derivatives.
TEST(CalibratedReprojectionFactor, OfAPointBehindTheCameraIsConstant) {
  const Scene scene;
  auto parameters = scene.parameters(true);
  parameters[2][2] = -0.5;
  const auto factor = scene.factor(true);
  std::vector<const double*> pointers;
  for (const auto& block : parameters) pointers.push_back(block.data());
  Eigen::Matrix<double, 2, 6, Eigen::RowMajor> by_camera0;
  double* jacobians[] = {nullptr, nullptr, nullptr, by_camera0.data(), nullptr, nullptr};
  parameters[2] = Vec3(50.0, -80.0, 0.4);
  Vec2 residual;
  pointers[2] = parameters[2].data();
  ASSERT_TRUE(factor.Evaluate(pointers.data(), residual.data(), jacobians));
  EXPECT_TRUE(residual.allFinite());
  EXPECT_EQ(by_camera0.norm(), 0.0);
}

}  // namespace
}  // namespace lodeline

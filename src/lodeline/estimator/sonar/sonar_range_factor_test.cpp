#include "lodeline/estimator/sonar/sonar_range_factor.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "lodeline/diagnostics.h"
#include "lodeline/factors/calibrated_reprojection_factor.h"
#include "lodeline/factors/numeric_jacobian.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

using Blocks = std::vector<Eigen::VectorXd>;

/// A wall, two host frames that see landmarks on it, and a sonar that looks at it.
struct SonarScene {
  Rigid3 pose{so3::exp(Vec3(0.2, -0.1, 0.6)), Vec3(1.0, -2.0, 0.5)};
  std::vector<Rigid3> hosts = {Rigid3(so3::exp(Vec3(0.1, 0.1, 0.5)), Vec3(0.6, -2.2, 0.4)),
                               Rigid3(so3::exp(Vec3(-0.1, 0.0, 0.8)), Vec3(0.8, -1.7, 0.7))};
  Rigid3 body_from_camera{so3::exp(Vec3(0.0, 1.5, 0.1)), Vec3(0.1, 0.05, -0.02)};
  Eigen::VectorXd camera_correction =
      (Eigen::VectorXd(6) << 0.01, -0.02, 0.015, 0.004, 0.003, -0.006).finished();
  SonarBeam beam{Vec3(0.05, -0.1, -0.15), so3::exp(Vec3(0.1, 0.05, -0.2)).toRotationMatrix()};
  Vec3 wall_normal_W = Vec3(-0.8, -0.5, 0.2).normalized();
  double wall_W = -3.5;  ///< normal . point

  Vec3 origin_W() const { return pose * beam.origin_B; }
  Vec3 onWall(const Vec3& origin_W, const Vec3& direction_W) const {
    return origin_W + (wall_W - wall_normal_W.dot(origin_W)) / wall_normal_W.dot(direction_W) * direction_W;
  }
  double range_m() const {
    const Vec3 along_W = pose.rotation * beam.axes_B.col(0);
    return (onWall(origin_W(), along_W) - origin_W()).norm();
  }
  Rigid3 camera() const { return correctedExtrinsics(body_from_camera, camera_correction.data()); }

  std::vector<SurfaceLandmark> landmarks() const {
    std::vector<SurfaceLandmark> members;
    for (size_t i = 0; i < 8; ++i) {
      const Vec3 in_camera = (hosts[i % 2] * camera()).inverse() * point_W(i);
      // The ray of the host is not quite that of the landmark.
      members.push_back({LandmarkBase((in_camera.normalized() + Vec3(0.01, -0.02, 0.005)).normalized()),
                         i % 2, 1.0 / (1.0 + static_cast<double>(i))});
    }
    return members;
  }
  Vec3 point_W(size_t i) const {
    const double radius = 0.05 + 0.015 * static_cast<double>(i), angle = 2.0 * static_cast<double>(i);
    const Vec3 ray(1.0, radius * std::cos(angle), radius * std::sin(angle));
    return onWall(origin_W(), (pose.rotation * (beam.axes_B * ray)).normalized());
  }
  Blocks blocks(bool with_camera = true) const {
    Blocks blocks = {poseVector(pose), poseVector(hosts[0]), poseVector(hosts[1])};
    if (with_camera) blocks.push_back(camera_correction);
    const std::vector<SurfaceLandmark> members = landmarks();
    for (size_t i = 0; i < members.size(); ++i) {
      const Vec3 in_camera = (hosts[i % 2] * camera()).inverse() * point_W(i);
      const double rho = 1.0 / members[i].base.bearing_C.dot(in_camera);
      const Vec2 ab = members[i].base.tangent_C.transpose() * in_camera * rho;
      blocks.push_back(Vec3(ab.x(), ab.y(), rho));
    }
    return blocks;
  }
  SonarRangeFactor factor(double range_m, double sigma_m = 0.05, SonarLinearizationPoints first = {}) const {
    return {range_m, sigma_m, beam, body_from_camera, true, hosts.size(), landmarks(), std::move(first)};
  }
};

double residualOf(const SonarRangeFactor& factor, const Blocks& blocks) {
  std::vector<const double*> pointers;
  for (const auto& block : blocks) pointers.push_back(block.data());
  double residual = 0.0;
  EXPECT_TRUE(factor.Evaluate(pointers.data(), &residual, nullptr));
  return residual;
}

Blocks disturbed(Blocks blocks) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0.0, 0.01);
  for (Eigen::VectorXd& block : blocks) {
    if (block.size() == kPoseSize) {
      Eigen::Matrix<double, 6, 1> step;
      for (double& s : step) s = normal(random);
      block = poseVector(perturbed(poseFromBlock(block.data()), step));
    } else {
      for (double& value : block) value += normal(random);
    }
  }
  return blocks;
}

TEST(SonarRangeFactor, IsZeroAtTheTruth) {
  const SonarScene scene;
  EXPECT_NEAR(residualOf(scene.factor(scene.range_m()), scene.blocks()), 0.0, 1e-5);
}

TEST(SonarRangeFactor, LeverArmMatters) {
  SonarScene scene;
  const double range_m = scene.range_m();
  const Blocks blocks = scene.blocks();
  const SonarRangeFactor right = scene.factor(range_m);
  scene.beam.origin_B += Vec3(0.2, 0.0, 0.0);
  const SonarRangeFactor wrong(range_m, 0.05, scene.beam, scene.body_from_camera, true, 2,
                               SonarScene().landmarks());
  EXPECT_NEAR(residualOf(right, blocks), 0.0, 1e-5);
  EXPECT_GT(std::abs(residualOf(wrong, blocks)), 2.0);
}

TEST(SonarRangeFactor, JacobiansAgreeWithNumericDifferentiation) {
  const SonarScene scene;
  expectJacobiansMatch(scene.factor(scene.range_m() + 0.1), disturbed(scene.blocks()));
}

TEST(SonarRangeFactor, JacobiansAgreeWithoutTheBlockOfTheCamera) {
  SonarScene scene;
  scene.camera_correction.setZero();
  const SonarRangeFactor factor(scene.range_m(), 0.05, scene.beam, scene.body_from_camera, false, 2,
                                scene.landmarks());
  expectJacobiansMatch(factor, disturbed(scene.blocks(false)));
}

TEST(SonarRangeFactor, WeighsByItsSigma) {
  const SonarScene scene;
  const Blocks blocks = scene.blocks();
  EXPECT_NEAR(residualOf(scene.factor(scene.range_m() - 0.1, 0.05), blocks), 2.0, 1e-4);
  EXPECT_NEAR(residualOf(scene.factor(scene.range_m() - 0.1, 0.1), blocks), 1.0, 1e-4);
}

TEST(SonarRangeFactor, SeesNeitherPlaceNorHeadingOfTheWorld) {
  const SonarScene scene;
  const SonarRangeFactor factor = scene.factor(scene.range_m() + 0.2);
  Blocks blocks = disturbed(scene.blocks());
  const double before = residualOf(factor, blocks);
  const Rigid3 motion(so3::exp(Vec3(0.0, 0.0, 1.3)), Vec3(4.0, -7.0, 2.0));
  for (size_t i = 0; i < 3; ++i) blocks[i] = poseVector(motion * poseFromBlock(blocks[i].data()));
  EXPECT_NEAR(residualOf(factor, blocks), before, 1e-9);
}

// A residual that does not change with the scale of the world would be of no use: twice the world, twice the
// predicted range.
TEST(SonarRangeFactor, SeesTheScale) {
  SonarScene scene;
  scene.body_from_camera.translation.setZero();
  scene.camera_correction.setZero();
  scene.beam.origin_B.setZero();
  const double range_m = scene.range_m();
  const SonarRangeFactor factor = scene.factor(range_m);
  Blocks blocks = scene.blocks();
  EXPECT_NEAR(residualOf(factor, blocks), 0.0, 1e-5);
  for (size_t i = 0; i < 3; ++i) blocks[i].head<3>() *= 2.0;
  for (size_t i = 4; i < blocks.size(); ++i) blocks[i][2] /= 2.0;
  EXPECT_NEAR(residualOf(factor, blocks), range_m / 0.05, 1e-4);
}

// The Jacobian at the linearization points has the null space of the residual, whatever the present values.
TEST(SonarRangeFactor, KeepsTheHeadingUnobservableAtLinearizationPoints) {
  const SonarScene scene;
  const Blocks first = disturbed(scene.blocks());
  SonarLinearizationPoints points;
  std::copy_n(first[0].data(), kPoseSize, points.pose.emplace().begin());
  points.hosts = {first[1].data(), first[2].data()};
  points.camera = first[3].data();
  const SonarRangeFactor factor = scene.factor(scene.range_m(), 0.05, points);
  const Blocks blocks = scene.blocks();
  std::vector<const double*> pointers;
  std::vector<Eigen::VectorXd> rows;
  std::vector<double*> jacobians;
  for (const auto& block : blocks) {
    pointers.push_back(block.data());
    rows.emplace_back(block.size());
  }
  for (Eigen::VectorXd& row : rows) jacobians.push_back(row.data());
  double residual = 0.0;
  ASSERT_TRUE(factor.Evaluate(pointers.data(), &residual, jacobians.data()));
  double turn = 0.0, size = 0.0;
  Vec3 shift = Vec3::Zero();
  for (size_t i = 0; i < 3; ++i) {
    const Vec3 position_W(first[i].data());
    turn += rows[i].head<3>().dot(Vec3::UnitZ().cross(position_W)) + rows[i][5];
    shift += rows[i].head<3>();
    size += rows[i].head<6>().norm();
  }
  EXPECT_GT(size, 1.0);
  EXPECT_LT(std::abs(turn), 1e-9 * size);
  EXPECT_LT(shift.norm(), 1e-9 * size);
}

TEST(SonarRangeFactor, SurfaceBehindTheSonarIsAGrossOutlierWithoutDerivatives) {
  const SonarScene scene;
  Blocks blocks = scene.blocks();
  for (size_t i = 4; i < blocks.size(); ++i) blocks[i][2] = 0.0;
  blocks[0] = poseVector(Rigid3(scene.pose.rotation, scene.pose.translation));
  const SonarRangeFactor factor = scene.factor(scene.range_m());
  std::vector<const double*> pointers;
  std::vector<Eigen::VectorXd> rows;
  std::vector<double*> jacobians;
  for (const auto& block : blocks) {
    pointers.push_back(block.data());
    rows.push_back(Eigen::VectorXd::Constant(block.size(), 1e300));
  }
  for (Eigen::VectorXd& row : rows) jacobians.push_back(row.data());
  double residual = 0.0;
  ASSERT_TRUE(factor.Evaluate(pointers.data(), &residual, jacobians.data()));
  EXPECT_GE(residual, 100.0);
  for (const Eigen::VectorXd& row : rows) EXPECT_EQ(row.cwiseAbs().maxCoeff(), 0.0);
}

TEST(SonarRangeFactor, RefusesWhatCannotBeWeighed) {
  const SonarScene scene;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const double range_m : {0.0, -1.0, kNan, std::numeric_limits<double>::infinity()})
    EXPECT_THROW(scene.factor(range_m), InputError) << range_m;
  for (const double sigma_m : {0.0, -1.0, kNan}) EXPECT_THROW(scene.factor(2.0, sigma_m), InputError);
  EXPECT_THROW(SonarRangeFactor(2.0, 0.05, scene.beam, scene.body_from_camera, true, 2, {}), InputError);
}

}  // namespace
}  // namespace lodeline

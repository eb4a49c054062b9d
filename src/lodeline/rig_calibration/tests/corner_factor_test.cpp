#include "lodeline/rig_calibration/problem/corner_factor.h"

#include <gtest/gtest.h>

#include "lodeline/factors/numeric_jacobian.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/rig_calibration/tests/test_board_record.h"

namespace lodeline {
namespace {

/// The factor of one corner before one camera. The camera follows the blocks of the evaluation.
class FollowingFactor final : public ceres::CostFunction {
 public:
  FollowingFactor(const RigState* rig, CameraState* camera, const FrameState* frame, const Vec3& corner_T,
                  const Vec2& pixel)
      : camera_(camera), factor_(rig, camera, frame, corner_T, pixel) {
    set_num_residuals(2);
    *mutable_parameter_block_sizes() = factor_.parameter_block_sizes();
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    std::copy(blocks[5], blocks[5] + camera_->lens.size(), camera_->lens.begin());
    if (camera_->base.port) std::copy(blocks[6], blocks[6] + kPortSize, camera_->port.begin());
    camera_->refresh();
    return factor_.Evaluate(blocks, residuals, jacobians);
  }

 private:
  CameraState* camera_;
  CornerFactor factor_;
};

struct FactorCase {
  std::string name;
  std::optional<Port> port;
};

class CornerFactorTest : public testing::TestWithParam<FactorCase> {};

Port flatPort() {
  Port port;
  port.normal_C = Vec3(0.01, -0.02, 1.0).normalized();
  port.distance_m = 0.02;
  port.thickness_m = 0.008;
  return port;
}

Port domePort() {
  Port port;
  port.type = Port::Type::Dome;
  port.centre_C = Vec3(0.002, -0.001, 0.004);
  port.radius_m = 0.05;
  port.thickness_m = 0.006;
  return port;
}

INSTANTIATE_TEST_SUITE_P(Ports, CornerFactorTest,
                         testing::Values(FactorCase{"none", std::nullopt}, FactorCase{"flat", flatPort()},
                                         FactorCase{"dome", domePort()}),
                         [](const auto& info) { return info.param.name; });

TEST_P(CornerFactorTest, HasTheDerivativesOfAllBlocks) {
  test::BoardTrial trial;
  trial.port = GetParam().port;
  CameraState camera(test::trueRig(trial).cameras[1]);
  camera.sigma_px = 0.2;
  RigState rig;
  rig.level_from_board = so3::exp(Vec3(0.2, -0.1, 0.4));
  FrameState frame;
  frame.gyroscope_reading_B = Vec3(0.5, -0.8, 0.3);
  // The camera looks at the board from 0.6 m, a little aslant.
  const Rigid3 world_from_camera(
      rig.level_from_board * so3::exp(Vec3(M_PI, 0.0, 0.0)) * so3::exp(Vec3(0.2, 0.3, -0.1)),
      rig.level_from_board * Vec3(0.1, 0.2, 0.6));
  const Rigid3 pose = world_from_camera * poseFromBlock(camera.body_from_camera.data()).inverse();
  std::vector<Eigen::VectorXd> blocks(camera.base.port ? 7 : 6);
  blocks[0].resize(kPoseSize);
  poseToBlock(pose, blocks[0].data());
  blocks[1].resize(kMotionSize);
  blocks[1] << 0.3, -0.2, 0.1, 0.01, -0.02, 0.005, 0.1, 0.0, -0.1;
  blocks[2] = Eigen::Map<Eigen::VectorXd>(camera.body_from_camera.data(), kPoseSize);
  blocks[3] = Eigen::VectorXd::Constant(1, 0.004);
  blocks[4] = Vec2(0.02, -0.01);
  blocks[5] = Eigen::Map<Eigen::VectorXd>(camera.lens.data(), static_cast<Eigen::Index>(camera.lens.size()));
  if (camera.base.port) blocks[6] = Eigen::VectorXd::Zero(kPortSize);
  const FollowingFactor factor(&rig, &camera, &frame, Vec3(0.15, 0.12, 0.0), Vec2(320.0, 240.0));
  // The derivative by the bias is of first order in the delay.
  expectJacobiansMatch(factor, blocks, 2e-3);
  blocks[3].setZero();
  expectJacobiansMatch(factor, blocks, 2e-5);
}

}  // namespace
}  // namespace lodeline

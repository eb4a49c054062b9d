#include "lodeline/factors/rolling_shutter.h"

#include <gtest/gtest.h>

#include "lodeline/factors/reprojection_scene.h"

namespace lodeline {
namespace {

/// A landmark that a moving camera observes while it reads its rows, from a target and from the host.
struct RollingScene : ReprojectionScene {
  Rigid3 body_from_camera{so3::exp(Vec3(0.1, -0.2, 0.2)), Vec3(-0.02, -0.06, 0.01)};
  double line_delay_s = 4e-5;  // 19 ms for 480 rows
  ImageMotion host_motion = motionOf(world_from_host, Vec3(0.3, -0.1, 0.05), Vec3(0.2, -0.4, 0.3));
  ImageMotion target_motion = motionOf(world_from_target, Vec3(0.25, 0.1, -0.02), Vec3(-0.1, 0.9, 0.5));
  Eigen::VectorXd zeros = Eigen::VectorXd::Zero(6), no_offset = Eigen::VectorXd::Zero(1);

  static ImageMotion motionOf(const Rigid3& world_from_body, const Vec3& velocity_W, const Vec3& turning_B) {
    return {velocity_W, turning_B, world_from_body.rotation.conjugate() * velocity_W};
  }

  /// What the camera measures: the row decides the time, and the time the row.
  DirectionMeasurement seenFrom(const Rigid3& world_from_body, const ImageMotion& motion) const {
    const Vec3 point_W = world_from_host * body_from_camera * point_host_C;
    DirectionMeasurement seen;
    double later_s = 0.0;
    for (int i = 0; i < 30; ++i) {
      const Rigid3 world_from_camera = motion.poseAfter(world_from_body, later_s) * body_from_camera;
      seen = measurement(world_from_camera.inverse() * point_W);
      later_s = line_delay_s * rowsBelowMiddle(seen, CameraMotion());
    }
    return seen;
  }

  RollingShutterFactor factor(const DirectionMeasurement& seen, bool host,
                              std::vector<const double*> first = std::vector<const double*>(5)) const {
    const ImageMotion motion = host ? host_motion : target_motion;
    const auto factor_of =
        [this, host](const DirectionMeasurement& measured) -> std::unique_ptr<ceres::CostFunction> {
      if (host) return std::make_unique<HostReprojectionFactor>(measured, base(), Rigid3());
      return std::make_unique<CalibratedReprojectionFactor>(
          measured, base(), CameraPlacement{body_from_camera, std::nullopt}, host_motion, target_motion);
    };
    return {factor_of, seen, CameraMotion(motion, body_from_camera), 1, std::move(first)};
  }
  std::vector<Eigen::VectorXd> parameters(bool host, double delay_s) const {
    Eigen::VectorXd shutter = Eigen::VectorXd::Zero(kShutterSize);
    shutter[1] = delay_s;
    if (host) return {landmark(), shutter};
    return {
        poseVector(world_from_host), poseVector(world_from_target), landmark(), zeros, no_offset, shutter};
  }
};

TEST(RollingShutter, IsZeroAtTruthAndOnlyThere) {
  const RollingScene scene;
  for (const bool host : {false, true}) {
    const DirectionMeasurement seen = host ? scene.seenFrom(scene.world_from_host, scene.host_motion)
                                           : scene.seenFrom(scene.world_from_target, scene.target_motion);
    const auto factor = scene.factor(seen, host);
    EXPECT_LT(evaluate(factor, scene.parameters(host, scene.line_delay_s)).norm(), 0.01);
    EXPECT_GT(evaluate(factor, scene.parameters(host, 0.0)).norm(), 0.5);
  }
}

TEST(RollingShutter, JacobiansMatchNumericDifferentiation) {
  const RollingScene scene;
  const DirectionMeasurement seen = scene.measurement(Vec3(0.5, -0.4, 2.4));
  for (const bool host : {false, true})
    expectJacobiansMatch(scene.factor(seen, host), scene.parameters(host, scene.line_delay_s));
}

TEST(RollingShutter, PointByLineDelayIsTheDerivative) {
  const RollingScene scene;
  const DirectionMeasurement seen = scene.measurement(Vec3(0.5, -0.4, 2.4));
  const CameraMotion motion(scene.target_motion, scene.body_from_camera);
  const double rho = 0.4, step_s = 1e-7;
  const Vec3 point_C(0.21, -0.15, 1.0);
  const auto residualAt = [&](double delay_s, Mat23* by_point) {
    const DirectionMeasurement moved = atTimeOfImage(seen, motion, delay_s);
    return directionResidual(moved, moved.fromOrigin(point_C, rho), by_point);
  };
  Mat23 by_point;
  residualAt(scene.line_delay_s, &by_point);
  const Vec2 analytic = by_point * pointByLineDelay(seen, motion, scene.line_delay_s, point_C, rho);
  const Vec2 numeric =
      (residualAt(scene.line_delay_s + step_s, nullptr) - residualAt(scene.line_delay_s - step_s, nullptr)) /
      (2.0 * step_s);
  EXPECT_LT((analytic - numeric).norm(), 1e-6 * numeric.norm());
}

TEST(RollingShutter, DoesNotDependOnTheWorldFrame) {
  const RollingScene scene;
  const DirectionMeasurement seen = scene.seenFrom(scene.world_from_target, scene.target_motion);
  const auto factor = scene.factor(seen, false);
  auto moved = scene.parameters(false, 1e-5);
  const Vec2 before = evaluate(factor, moved);
  const Rigid3 other(so3::exp(Vec3(0.0, 0.0, 1.3)), Vec3(4.0, -3.0, 2.0));
  moved[0] = poseVector(other * scene.world_from_host);
  moved[1] = poseVector(other * scene.world_from_target);
  EXPECT_LT((evaluate(factor, moved) - before).norm(), 1e-8);
}

TEST(RollingShutter, WithoutDelayIsThePlainFactorAndAtRestKnowsNothing) {
  RollingScene scene;
  const DirectionMeasurement seen = scene.measurement(Vec3(0.5, -0.4, 2.4));
  const CalibratedReprojectionFactor plain(seen, scene.base(), {scene.body_from_camera, std::nullopt},
                                           scene.host_motion, scene.target_motion);
  auto without = scene.parameters(false, 0.0);
  auto of_plain = without;
  of_plain.pop_back();
  EXPECT_LT((evaluate(scene.factor(seen, false), without) - evaluate(plain, of_plain)).norm(), 1e-12);

  scene.target_motion = ImageMotion{};
  const auto at_rest = scene.factor(seen, false);
  EXPECT_LT((evaluate(at_rest, scene.parameters(false, 0.0)) -
             evaluate(at_rest, scene.parameters(false, scene.line_delay_s)))
                .norm(),
            1e-12);
  // A row at the height of the principal point is exposed at the time of the image.
  const RollingScene moving;
  const Vec3 level_C = *moving.camera->unproject(Vec2(500.0, 248.0));
  const auto of_centre = moving.factor(moving.measurement(level_C), false);
  EXPECT_LT((evaluate(of_centre, moving.parameters(false, 0.0)) -
             evaluate(of_centre, moving.parameters(false, moving.line_delay_s)))
                .norm(),
            1e-3);
}

}  // namespace
}  // namespace lodeline

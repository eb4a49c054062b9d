// Reprojection factors of cameras behind ports, whose rays have no common point.

#include <gtest/gtest.h>

#include <random>

#include "lodeline/cameras/port_camera.h"
#include "lodeline/factors/calibrated_reprojection_factor.h"
#include "lodeline/factors/ports/port_factor.h"
#include "lodeline/factors/reprojection_scene.h"

namespace lodeline {
namespace {

Port aslantPlate() {
  Port port;
  port.normal_C = Vec3(0.014, -0.02, 1.0).normalized();
  port.distance_m = 0.03;
  port.thickness_m = 0.01;
  return port;
}

Port decentredDome() {
  Port port;
  port.type = Port::Type::Dome;
  port.centre_C = Vec3(0.003, -0.004, 0.012);
  port.radius_m = 0.05;
  port.thickness_m = 0.006;
  return port;
}

/// A landmark that two cameras observe through ports, from two poses of the body.
struct PortScene : ReprojectionScene {
  Rigid3 body_from_camera0{so3::exp(Vec3(0.1, -1.5, 0.2)), Vec3(-0.02, -0.06, 0.01)};
  Rigid3 camera0_from_camera1{so3::exp(Vec3(0.01, -0.02, 0.005)), Vec3(0.11, 0.002, -0.001)};

  PortScene(const Port& port, double range_m) {
    CameraCalibration file = calibration();
    file.port = port;
    camera = makeCamera(file);
    point_host_C = range_m * Vec3(0.2, -0.15, 1.0).normalized();
  }
  Rigid3 bodyFromCamera1() const { return body_from_camera0 * camera0_from_camera1; }
  Vec3 pointIn(const Rigid3& world_from_body, const Rigid3& body_from_camera) const {
    return (world_from_body * body_from_camera).inverse() *
           (world_from_host * (body_from_camera0 * point_host_C));
  }
  /// The measurement of the pixel of a point, with an error of the pixel.
  DirectionMeasurement seen(const Vec3& point_C, const Vec2& error_px = Vec2::Zero(),
                            double sigma_px = 0.7) const {
    const ViewRay ray = camera->viewRay(*camera->project(point_C) + error_px)->fromNearestPoint();
    return DirectionMeasurement::fromRay(*camera, ray, sigma_px);
  }
  ReprojectionFactor plain(const Vec2& error_px = Vec2::Zero(), double sigma_px = 0.7) const {
    return {seen(pointIn(world_from_target, bodyFromCamera1()), error_px, sigma_px),
            base(),
            body_from_camera0,
            bodyFromCamera1(),
            nullptr,
            nullptr};
  }
  std::vector<Eigen::VectorXd> poses() const {
    return {poseVector(world_from_host), poseVector(world_from_target), landmark()};
  }
  HostReprojectionFactor host(const Vec2& error_px = Vec2::Zero()) const {
    return {seen(pointIn(world_from_host, bodyFromCamera1()), error_px), base(),
            camera0_from_camera1.inverse()};
  }
  CalibratedReprojectionFactor calibrated(const Vec2& error_px = Vec2::Zero()) const {
    return {seen(pointIn(world_from_target, bodyFromCamera1()), error_px),
            base(),
            {body_from_camera0, camera0_from_camera1},
            {},
            {}};
  }
  CalibratedStereoFactor stereo(const Vec2& error_px = Vec2::Zero()) const {
    return {seen(pointIn(world_from_host, bodyFromCamera1()), error_px), base(), camera0_from_camera1};
  }
  std::vector<Eigen::VectorXd> calibratedBlocks() const {
    auto blocks = poses();
    for (const int size : {6, 1, 6}) blocks.push_back(Eigen::VectorXd::Zero(size));
    return blocks;
  }
};

class PortReprojection : public testing::TestWithParam<double> {
 protected:
  std::vector<PortScene> scenes() const {
    return {PortScene(aslantPlate(), GetParam()), PortScene(decentredDome(), GetParam())};
  }
};
INSTANTIATE_TEST_SUITE_P(Distances, PortReprojection, testing::Values(0.4, 1.0, 2.5, 30.0));

TEST_P(PortReprojection, IsZeroAtTruthAtEveryDistance) {
  for (const PortScene& scene : scenes()) {
    EXPECT_LT(evaluate(scene.plain(), scene.poses()).norm(), 1e-9);
    EXPECT_LT(evaluate(scene.host(), {scene.landmark()}).norm(), 1e-9);
    EXPECT_LT(evaluate(scene.calibrated(), scene.calibratedBlocks()).norm(), 1e-9);
    EXPECT_LT(evaluate(scene.stereo(), {scene.landmark(), Eigen::VectorXd::Zero(6)}).norm(), 1e-9);
  }
}

TEST_P(PortReprojection, JacobiansMatchNumericDifferentiation) {
  const Vec2 error_px(1.2, -0.8);
  for (const PortScene& scene : scenes()) {
    expectJacobiansMatch(scene.plain(error_px), scene.poses());
    expectJacobiansMatch(scene.host(error_px), {scene.landmark()});
    expectJacobiansMatch(scene.calibrated(error_px), scene.calibratedBlocks());
    expectJacobiansMatch(scene.stereo(error_px), {scene.landmark(), Eigen::VectorXd::Zero(6)});
    auto at_infinity = scene.poses();
    at_infinity[2][2] = 0.0;
    expectJacobiansMatch(scene.plain(error_px), at_infinity);
  }
}

// The weight is that of the nominal distance. Two per cent of it change with the distance.
TEST_P(PortReprojection, IsWhitened) {
  for (const PortScene& scene : scenes()) {
    std::mt19937 generator(7);
    std::normal_distribution<double> normal(0.0, 0.5);
    constexpr int kRuns = 1000;
    double chi_squared = 0.0;
    for (int i = 0; i < kRuns; ++i) {
      const Vec2 error_px(normal(generator), normal(generator));
      chi_squared += evaluate(scene.plain(error_px, 0.5), scene.poses()).squaredNorm();
    }
    // Mean of 1000 chi-squared variables of 2 degrees: 2 +- 0.063.
    EXPECT_NEAR(chi_squared / kRuns, 2.0, 0.25);
  }
}

TEST_P(PortReprojection, IsInvariantUnderAnyMotionOfTheWorld) {
  for (PortScene scene : scenes()) {
    const auto factor = scene.plain(Vec2(2.0, -1.0));
    const Vec2 before = evaluate(factor, scene.poses());
    scene.moveWorld();
    EXPECT_LT((evaluate(factor, scene.poses()) - before).norm(), 1e-9);
  }
}

TEST_P(PortReprojection, IsTheFactorOfTheLensWithoutRefraction) {
  for (PortScene scene : scenes()) {
    CameraCalibration file = scene.camera->calibration();
    file.port->index_air = file.port->index_glass = file.port->index_water = 1.0;
    scene.camera = makeCamera(file);
    const Vec2 with_port = evaluate(scene.plain(Vec2(1.0, 0.5)), scene.poses());
    file.port.reset();
    scene.camera = makeCamera(file);
    EXPECT_LT((evaluate(scene.plain(Vec2(1.0, 0.5)), scene.poses()) - with_port).norm(), 1e-6);
  }
}

TEST_P(PortReprojection, APointBehindTheCameraIsAConstantOutlier) {
  for (const PortScene& scene : scenes()) {
    const auto factor = scene.plain();
    // Turned about its own axis, the target looks the other way.
    auto blocks = scene.poses();
    blocks[1] = poseVector(scene.world_from_target * Rigid3(so3::exp(Vec3(0.0, 0.0, 3.1)), Vec3::Zero()));
    const Vec3 point_C = scene.pointIn(poseFromBlock(blocks[1].data()), scene.bodyFromCamera1());
    ASSERT_LT(point_C.z(), 0.0);
    EXPECT_GT(evaluate(factor, blocks).norm(), 1e3);
    EXPECT_TRUE(evaluate(factor, blocks).allFinite());
  }
}

/// Scenes whose camera has another port than its file states, and the change from the file.
struct MovedPortScene : PortScene {
  std::shared_ptr<const RefractiveCamera> by_file;
  Vec3 change;

  MovedPortScene(const Port& file, const Vec3& change, double range_m)
      : PortScene(correctedPort(file, change), range_m), change(change) {
    CameraCalibration stated = camera->calibration();
    stated.port = file;
    by_file = std::dynamic_pointer_cast<const RefractiveCamera>(makeCamera(stated));
  }
  /// The measurement of a point by the file.
  DirectionMeasurement stated(const Vec3& point_C, const Vec2& error_px, double sigma_px) const {
    const ViewRay ray = by_file->viewRay(*camera->project(point_C) + error_px)->fromNearestPoint();
    return DirectionMeasurement::fromRay(*by_file, ray, sigma_px);
  }
  DirectionMeasurement inTarget(const Vec2& error_px = Vec2::Zero(), double sigma_px = 0.7) const {
    return stated(pointIn(world_from_target, bodyFromCamera1()), error_px, sigma_px);
  }
  PortFactor calibratedPort(const Vec2& error_px = Vec2::Zero(), double sigma_px = 0.7) const {
    const CameraPlacement placement{body_from_camera0, camera0_from_camera1};
    const auto factor_of = [&](const DirectionMeasurement& ray) -> std::unique_ptr<ceres::CostFunction> {
      return std::make_unique<CalibratedReprojectionFactor>(ray, base(), placement, ImageMotion(),
                                                            ImageMotion());
    };
    return {factor_of, inTarget(error_px, sigma_px), by_file};
  }
  PortFactor stereoPort(const Vec2& error_px = Vec2::Zero()) const {
    const auto factor_of = [&](const DirectionMeasurement& ray) -> std::unique_ptr<ceres::CostFunction> {
      return std::make_unique<CalibratedStereoFactor>(ray, base(), camera0_from_camera1);
    };
    return {factor_of, stated(pointIn(world_from_host, bodyFromCamera1()), error_px, 0.7), by_file};
  }
  std::vector<Eigen::VectorXd> withPort() const {
    auto blocks = calibratedBlocks();
    blocks.push_back(change);
    return blocks;
  }
};

class MovedPort : public testing::TestWithParam<double> {
 protected:
  std::vector<MovedPortScene> scenes() const {
    return {{aslantPlate(), Vec3(0.009, -0.012, 0.003), GetParam()},
            {decentredDome(), Vec3(-0.002, 0.003, 0.0015), GetParam()},
            {aslantPlate(), Vec3::Zero(), GetParam()}};
  }
};
INSTANTIATE_TEST_SUITE_P(Distances, MovedPort, testing::Values(0.4, 1.0, 2.5, 30.0));

TEST_P(MovedPort, IsZeroAtTheTruePortAlone) {
  for (const MovedPortScene& scene : scenes()) {
    EXPECT_LT(evaluate(scene.calibratedPort(), scene.withPort()).norm(), 1e-6);
    EXPECT_LT(evaluate(scene.stereoPort(), {scene.landmark(), Eigen::VectorXd::Zero(6), scene.change}).norm(),
              1e-6);
    if (scene.change.isZero()) continue;
    auto by_file = scene.withPort();
    by_file.back().setZero();
    EXPECT_GT(evaluate(scene.calibratedPort(), by_file).norm(), 0.5);
  }
}

TEST_P(MovedPort, JacobiansMatchNumericDifferentiation) {
  const Vec2 error_px(1.2, -0.8);
  for (const MovedPortScene& scene : scenes()) {
    expectJacobiansMatch(scene.calibratedPort(error_px), scene.withPort());
    expectJacobiansMatch(scene.stereoPort(error_px),
                         {scene.landmark(), Eigen::VectorXd::Zero(6), scene.change});
  }
}

// The pixel error over sigma, exactly: the weight of a ray is that of the nominal distance.
TEST_P(MovedPort, IsThePixelErrorOverItsSigma) {
  const Vec2 error_px(1.5, -0.7);
  for (const MovedPortScene& scene : scenes()) {
    const Vec2 residual = evaluate(scene.calibratedPort(error_px, 0.5), scene.withPort());
    EXPECT_LT((residual + error_px / 0.5).norm(), 1e-6);
  }
}

TEST_P(MovedPort, IsInvariantUnderAnyMotionOfTheWorld) {
  for (MovedPortScene scene : scenes()) {
    const auto factor = scene.calibratedPort(Vec2(2.0, -1.0));
    const Vec2 before = evaluate(factor, scene.withPort());
    scene.moveWorld();
    EXPECT_LT((evaluate(factor, scene.withPort()) - before).norm(), 1e-8);
  }
}

TEST_P(MovedPort, AgreesWithTheRayThroughThePort) {
  const Vec2 error_px(0.4, -0.3);
  for (const MovedPortScene& scene : scenes()) {
    const CalibratedReprojectionFactor ray(
        throughPort(*scene.by_file, scene.inTarget(error_px), scene.change), scene.base(),
        {scene.body_from_camera0, scene.camera0_from_camera1}, {}, {});
    const Vec2 exact = evaluate(scene.calibratedPort(error_px), scene.withPort());
    EXPECT_LT((evaluate(ray, scene.calibratedBlocks()) - exact).norm(), 0.05 * exact.norm());
  }
}

TEST_P(MovedPort, WhatHasNoPixelIsAConstantOutlier) {
  for (const MovedPortScene& scene : scenes()) {
    const auto factor = scene.calibratedPort();
    auto behind = scene.withPort();
    behind[1] = poseVector(scene.world_from_target * Rigid3(so3::exp(Vec3(0.0, 0.0, 3.1)), Vec3::Zero()));
    auto impossible = scene.withPort();
    impossible.back().setConstant(-0.5);  // half a metre behind the lens
    for (const auto& blocks : {behind, impossible}) {
      std::vector<const double*> at;
      for (const auto& block : blocks) at.push_back(block.data());
      Eigen::Matrix<double, 2, kPortChangeSize, Eigen::RowMajor> by_port;
      std::vector<double*> jacobians(blocks.size(), nullptr);
      jacobians.back() = by_port.data();
      Vec2 residual;
      ASSERT_TRUE(factor.Evaluate(at.data(), residual.data(), jacobians.data()));
      EXPECT_GT(residual.norm(), 1e3);
      EXPECT_TRUE(by_port.isZero());
    }
  }
}

}  // namespace
}  // namespace lodeline

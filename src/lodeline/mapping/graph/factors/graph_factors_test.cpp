#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "lodeline/diagnostics.h"
#include "lodeline/factors/numeric_jacobian.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/graph/factors/heading_factor.h"
#include "lodeline/mapping/graph/factors/height_factor.h"
#include "lodeline/mapping/graph/factors/landmark_observation_factor.h"
#include "lodeline/mapping/graph/factors/position_factor.h"
#include "lodeline/mapping/graph/factors/relative_pose_factor.h"
#include "lodeline/mapping/graph/factors/tilt_factor.h"
#include "lodeline/mapping/graph/test_graphs.h"

namespace lodeline {
namespace {

using Parameters = std::vector<Eigen::VectorXd>;

const Rigid3 kFrom(so3::exp(Vec3(0.3, -0.2, 1.9)), Vec3(4, -2, 1));
const Rigid3 kTo(so3::exp(Vec3(-0.1, 0.4, -2.2)), Vec3(6, 1, 0.5));
const Quat kOdomFromBody = Quat(Eigen::AngleAxisd(-0.7, Vec3::UnitZ())) * kFrom.rotation;  // azimuth 0.7

Mat6 tiltedCovariance() {
  Mat6 root = Mat6::Identity();
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) root(i, j) += 0.3 * std::sin(1.0 + 2.0 * i + 3.0 * j);
  }
  return 1e-4 * root * root.transpose();
}

Eigen::VectorXd scalar(double value) { return Eigen::VectorXd::Constant(1, value); }

Eigen::VectorXd residualOf(const ceres::CostFunction& factor, const Parameters& parameters) {
  std::vector<const double*> pointers;
  for (const auto& block : parameters) pointers.push_back(block.data());
  Eigen::VectorXd residual(factor.num_residuals());
  EXPECT_TRUE(factor.Evaluate(pointers.data(), residual.data(), nullptr));
  return residual;
}

/// A common motion of the world: translation and azimuth.
const Rigid3 kMotion(Quat(Eigen::AngleAxisd(1.1, Vec3::UnitZ())), Vec3(30, -20, 5));

TEST(GraphFactors, AreZeroAtTruth) {
  const Vec3 seen_W(5, 0, 2);
  EXPECT_LT(residualOf(RelativePoseFactor({kFrom.inverse() * kTo, tiltedCovariance()}),
                       {poseVector(kFrom), poseVector(kTo)})
                .norm(),
            1e-10);
  EXPECT_LT(
      residualOf(TiltFactor(kFrom.rotation.conjugate() * Vec3::UnitZ(), 0.01), {poseVector(kFrom)}).norm(),
      1e-10);
  EXPECT_LT(residualOf(HeadingFactor(kOdomFromBody, 0.01), {poseVector(kFrom), scalar(0.7)}).norm(), 1e-10);
  EXPECT_LT(residualOf(HeightFactor(1.2, 0.01), {poseVector(kFrom), scalar(0.2)}).norm(), 1e-10);
  // The origin of odometry is at -0.2 m, 12.2 m below a surface at 12 m.
  EXPECT_LT(residualOf(OriginDepthFactor(12.2, 0.01), {scalar(0.2), scalar(12.0)}).norm(), 1e-10);
  EXPECT_LT(
      residualOf(PositionFactor(kFrom * Vec3(1, 2, 3), Mat3::Identity(), Vec3(1, 2, 3)), {poseVector(kFrom)})
          .norm(),
      1e-10);
  EXPECT_LT(residualOf(LandmarkObservationFactor(kFrom.inverse() * seen_W, Mat3::Identity()),
                       {poseVector(kFrom), Eigen::VectorXd(seen_W)})
                .norm(),
            1e-10);
}

TEST(GraphFactors, JacobiansMatchNumericDifferentiation) {
  const Mat3 covariance = tiltedCovariance().topLeftCorner<3, 3>();
  const RelativePose measured{Rigid3(so3::exp(Vec3(0.3, 0.1, 0.8)), Vec3(1, 2, -1)), tiltedCovariance()};
  expectJacobiansMatch(RelativePoseFactor(measured), {poseVector(kFrom), poseVector(kTo)});
  expectJacobiansMatch(TiltFactor(Vec3(0.6, 0.0, 0.8), 0.01), {poseVector(kFrom)});
  expectJacobiansMatch(TiltFactor(kFrom.rotation.conjugate() * Vec3::UnitZ(), 0.01), {poseVector(kFrom)});
  expectJacobiansMatch(HeadingFactor(kTo.rotation, 0.01), {poseVector(kFrom), scalar(0.3)});
  expectJacobiansMatch(HeightFactor(1.0, 0.02), {poseVector(kFrom), scalar(0.3)});
  expectJacobiansMatch(OriginDepthFactor(7.0, 0.02), {scalar(0.3), scalar(6.0)});
  expectJacobiansMatch(PositionFactor(Vec3(1, 1, 1), covariance, Vec3(0.3, -0.2, 0.1)), {poseVector(kFrom)});
  expectJacobiansMatch(LandmarkObservationFactor(Vec3(1, 1, 1), covariance),
                       {poseVector(kFrom), Eigen::VectorXd(Vec3(3, 2, 1))});
}

TEST(GraphFactors, DoNotChangeWithACommonMotionOfTheWorld) {
  const RelativePoseFactor edge({Rigid3(so3::exp(Vec3(0.3, 0.1, 0.8)), Vec3(1, 2, -1)), tiltedCovariance()});
  EXPECT_LT((residualOf(edge, {poseVector(kFrom), poseVector(kTo)}) -
             residualOf(edge, {poseVector(kMotion * kFrom), poseVector(kMotion * kTo)}))
                .norm(),
            1e-9);
  const TiltFactor tilt(Vec3(0.6, 0.0, 0.8), 0.01);
  EXPECT_NEAR(residualOf(tilt, {poseVector(kFrom)}).norm(),
              residualOf(tilt, {poseVector(kMotion * kFrom)}).norm(), 1e-9);
  const HeadingFactor heading(kTo.rotation, 0.01);
  EXPECT_NEAR(residualOf(heading, {poseVector(kFrom), scalar(0.3)})[0],
              residualOf(heading, {poseVector(kMotion * kFrom), scalar(0.3 + 1.1)})[0], 1e-9);
  const LandmarkObservationFactor observation(Vec3(1, 1, 1), Mat3::Identity());
  EXPECT_LT((residualOf(observation, {poseVector(kFrom), Eigen::VectorXd(Vec3(3, 2, 1))}) -
             residualOf(observation, {poseVector(kMotion * kFrom), Eigen::VectorXd(kMotion * Vec3(3, 2, 1))}))
                .norm(),
            1e-9);
}

TEST(GraphFactors, AreWhiteUnderTheirOwnNoise) {
  std::mt19937_64 generator(3);
  const Mat6 covariance = tiltedCovariance();
  const Mat3 covariance_3 = covariance.bottomRightCorner<3, 3>();
  const Vec3 seen_W(5, 0, 2);
  const int trials = 4000;
  Mat6 edge = Mat6::Zero();
  Mat3 observation = Mat3::Zero(), position = Mat3::Zero();
  for (int k = 0; k < trials; ++k) {
    const RelativePose measured = withError({kFrom.inverse() * kTo, covariance}, &generator);
    const Vec6 r = residualOf(RelativePoseFactor(measured), {poseVector(kFrom), poseVector(kTo)});
    edge += r * r.transpose() / trials;
    const Vec3 point_B = kFrom.inverse() * seen_W + drawn(covariance_3, &generator);
    const Vec3 s = residualOf(LandmarkObservationFactor(point_B, covariance_3),
                              {poseVector(kFrom), Eigen::VectorXd(seen_W)});
    observation += s * s.transpose() / trials;
    const Vec3 position_W = kFrom.translation + drawn(covariance_3, &generator);
    const Vec3 p = residualOf(PositionFactor(position_W, covariance_3, Vec3::Zero()), {poseVector(kFrom)});
    position += p * p.transpose() / trials;
  }
  // Entries of a sample covariance scatter by sqrt(2 / n) = 0.022 at most; 4.5 sigma.
  EXPECT_LT((edge - Mat6::Identity()).cwiseAbs().maxCoeff(), 0.1);
  EXPECT_LT((observation - Mat3::Identity()).cwiseAbs().maxCoeff(), 0.1);
  EXPECT_LT((position - Mat3::Identity()).cwiseAbs().maxCoeff(), 0.1);
}

TEST(GraphFactors, MeasureAnglesInSigmas) {
  const Rigid3 tilted(so3::exp(Vec3(0.02, 0.0, 0.0)), Vec3::Zero());
  EXPECT_NEAR(residualOf(TiltFactor(Vec3::UnitZ(), 0.01), {poseVector(tilted)}).norm(), 2.0, 1e-9);
  const Rigid3 far(so3::exp(Vec3(0.0, 3.0, 0.0)), Vec3::Zero());
  EXPECT_NEAR(residualOf(TiltFactor(Vec3::UnitZ(), 0.01), {poseVector(far)}).norm(), 300.0, 1e-6);
  const Rigid3 turned(Quat(Eigen::AngleAxisd(3.1, Vec3::UnitZ())), Vec3::Zero());
  // 3.1 and -3.1 differ by 2 pi - 6.2, not by 6.2.
  EXPECT_NEAR(residualOf(HeadingFactor(Quat::Identity(), 0.01), {poseVector(turned), scalar(-3.1)})[0],
              (6.2 - 2.0 * std::numbers::pi) / 0.01, 1e-6);
}

TEST(GraphFactors, HaveFiniteValuesWhereADirectionIsUndefined) {
  const Rigid3 upside_down(Quat(Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitX())), Vec3::Zero());
  const Eigen::VectorXd pose = poseVector(upside_down);
  const double azimuth = 0.0;
  const double* parameters[2] = {pose.data(), &azimuth};
  double residual[2], jacobian[14], by_azimuth[1];
  double* jacobians[2] = {jacobian, by_azimuth};
  ASSERT_TRUE(TiltFactor(Vec3::UnitZ(), 0.01).Evaluate(parameters, residual, jacobians));
  for (const double value : jacobian) EXPECT_TRUE(std::isfinite(value));
  EXPECT_TRUE(std::isfinite(residual[0]) && std::isfinite(residual[1]));
  ASSERT_TRUE(HeadingFactor(Quat::Identity(), 0.01).Evaluate(parameters, residual, jacobians));
  for (int i = 0; i < 7; ++i) EXPECT_TRUE(std::isfinite(jacobian[i]));
  EXPECT_TRUE(std::isfinite(residual[0]));
}

TEST(GraphFactors, RefuseNoiseThatIsNone) {
  Mat6 flat = Mat6::Identity();
  flat(5, 5) = 0.0;
  EXPECT_THROW(RelativePoseFactor({Rigid3(), flat}), InputError);
  EXPECT_THROW(RelativePoseFactor({Rigid3(Quat(2, 0, 0, 0), Vec3::Zero()), Mat6::Identity()}), InputError);
  EXPECT_THROW(TiltFactor(Vec3::UnitZ(), 0.0), InputError);
  EXPECT_THROW(TiltFactor(Vec3::Zero(), 0.1), InputError);
  EXPECT_THROW(HeadingFactor(Quat::Identity(), -1.0), InputError);
  EXPECT_THROW(HeightFactor(std::nan(""), 1.0), InputError);
  EXPECT_THROW(OriginDepthFactor(1.0, 0.0), InputError);
  EXPECT_THROW(PositionFactor(Vec3::Zero(), -Mat3::Identity(), Vec3::Zero()), InputError);
  EXPECT_THROW(LandmarkObservationFactor(Vec3::Constant(INFINITY), Mat3::Identity()), InputError);
}

}  // namespace
}  // namespace lodeline

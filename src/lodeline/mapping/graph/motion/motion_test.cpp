#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <numbers>
#include <random>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/graph/motion/level_motion.h"
#include "lodeline/mapping/graph/motion/odometry_chain.h"
#include "lodeline/mapping/graph/motion/odometry_edge.h"
#include "lodeline/mapping/graph/test_graphs.h"

namespace lodeline {
namespace {

const Rigid3 kFirst(so3::exp(Vec3(0.2, -0.5, 1.0)), Vec3(3, -1, 2));
const Rigid3 kSecond(so3::exp(Vec3(-0.4, 0.1, -0.7)), Vec3(-1, 2, 0.5));

Mat6 unequalCovariance() {
  Vec6 sigmas;
  sigmas << 0.02, 0.05, 0.01, 0.004, 0.002, 0.01;
  Mat6 mixed = sigmas.asDiagonal();
  mixed(0, 5) = mixed(4, 1) = 0.006;
  return mixed * mixed.transpose();
}

double relativeDifference(const Mat6& a, const Mat6& b) { return (a - b).norm() / b.norm(); }

/// Covariance of the error of a pose over many draws.
template <typename Draw>
Mat6 sampleCovariance(const Rigid3& truth, Draw&& draw, int trials) {
  Mat6 sum = Mat6::Zero();
  for (int k = 0; k < trials; ++k) {
    const Vec6 error = errorBetween(draw(), truth);
    sum += error * error.transpose() / trials;
  }
  return sum;
}

TEST(RelativePose, ComposesCovariancesAsDrawsDo) {
  std::mt19937_64 generator(1);
  const RelativePose first{kFirst, unequalCovariance()}, second{kSecond, 0.5 * unequalCovariance()};
  const RelativePose both = composed(first, second);
  const auto draw = [&] {
    return withError(first, &generator).from_from_to * withError(second, &generator).from_from_to;
  };
  // A sample covariance of 20 000 draws scatters by 1 %.
  EXPECT_LT(relativeDifference(sampleCovariance(kFirst * kSecond, draw, 20000), both.covariance), 0.04);
}

TEST(RelativePose, InvertsCovariancesAsDrawsDo) {
  std::mt19937_64 generator(2);
  const RelativePose pose{kFirst, unequalCovariance()};
  const RelativePose inverse = inverted(pose);
  const auto draw = [&] { return withError(pose, &generator).from_from_to.inverse(); };
  EXPECT_LT(relativeDifference(sampleCovariance(kFirst.inverse(), draw, 20000), inverse.covariance), 0.04);
  EXPECT_LT(relativeDifference(inverted(inverse).covariance, pose.covariance), 1e-12);
}

MapKeyframe keyframeAt(KeyframeId id, const Rigid3& pose, const Mat6& covariance) {
  MapKeyframe keyframe;
  keyframe.id = id;
  keyframe.odom_from_body = pose;
  keyframe.covariance = covariance;
  return keyframe;
}

/// Covariance in world axes of a pose reached from `from` by an edge.
Mat6 propagated(const Rigid3& from, const Mat6& covariance_W, const RelativePose& edge) {
  Mat6 turned = Mat6::Zero(), carried = Mat6::Identity();
  turned.topLeftCorner<3, 3>() = turned.bottomRightCorner<3, 3>() = from.rotation.toRotationMatrix();
  carried.topRightCorner<3, 3>() = -so3::skew(from.rotation * edge.from_from_to.translation);
  return carried * covariance_W * carried.transpose() + turned * edge.covariance * turned.transpose();
}

TEST(OdometryEdge, RecoversTheCovarianceThatArose) {
  const RelativePose edge{kSecond, unequalCovariance()};
  const Mat6 before = 3.0 * unequalCovariance();
  const RelativePose found = odometryEdge(keyframeAt(0, kFirst, before),
                                          keyframeAt(1, kFirst * kSecond, propagated(kFirst, before, edge)));
  EXPECT_LT(errorBetween(found.from_from_to, kSecond).norm(), 1e-12);
  // The floor of 2.3 m is far below this covariance in all directions.
  EXPECT_LT(relativeDifference(found.covariance, edge.covariance), 1e-9);
}

TEST(OdometryEdge, AddsNothingForTheHeadingErrorBefore) {
  Mat6 before = Mat6::Zero();
  before(5, 5) = 1.0;
  const RelativePose edge{Rigid3(Quat::Identity(), Vec3(5, 0, 0)), 1e-2 * Mat6::Identity()};
  const Mat6 after = propagated(Rigid3(), before, edge);
  EXPECT_GT(after(1, 1), 25.0);  // a heading error of 1 rad moves a point at 5 m by 5 m
  const RelativePose found =
      odometryEdge(keyframeAt(0, Rigid3(), before), keyframeAt(1, edge.from_from_to, after));
  EXPECT_LT(relativeDifference(found.covariance, edge.covariance), 1e-9);
}

TEST(OdometryFactor, HasTheCovarianceOfACorrection) {
  // A reading of all six values with the covariance N corrects an estimate with the covariance P.
  const Mat6 P = 2.0 * unequalCovariance();
  const Mat6 N = 0.5 * unequalCovariance() + 0.02 * Mat6::Identity();
  const Mat6 gain = P * (P + N).inverse();
  const Mat6 after = P - gain * P;
  const Eigen::LLT<Mat6> of_error(P), of_reading(N);
  std::mt19937_64 generator(4);
  std::normal_distribution<double> normal;
  Mat6 sum = Mat6::Zero();
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    Vec6 error, noise;
    for (int k = 0; k < 6; ++k) error[k] = normal(generator), noise[k] = normal(generator);
    error = of_error.matrixL() * error;
    noise = of_reading.matrixL() * noise;
    const Vec6 correction = gain * (error + noise);
    sum += correction * correction.transpose() / kDraws;
  }
  Mat6 to_body = Mat6::Zero();
  to_body.topLeftCorner<3, 3>() = to_body.bottomRightCorner<3, 3>() =
      kFirst.rotation.conjugate().toRotationMatrix();
  const MapKeyframe first = keyframeAt(0, kFirst, P), next = keyframeAt(1, kFirst, after);
  EXPECT_LT(relativeDifference(to_body * sum * to_body.transpose(), odometryFactor(first, next).covariance),
            0.04);
  // What arises is nothing, and the end of a chain has the covariance of what was left.
  EXPECT_LT(odometryEdge(first, next).covariance.norm(), 1e-3 * after.norm());
}

TEST(OdometryEdge, IsAtLeastTheFloor) {
  const OdometryFloor floor;
  const MapKeyframe before = keyframeAt(0, kFirst, unequalCovariance());
  for (const double share : {0.1, 1.0 - 1e-7, 1.0 + 1e-7}) {
    const MapKeyframe after = keyframeAt(1, kFirst * kSecond, share * unequalCovariance());
    const Mat6 found = odometryEdge(before, after, 7.0).covariance;
    const Eigen::GeneralizedSelfAdjointEigenSolver<Mat6> relative(found, floor.covariance(7.0));
    EXPECT_GT(relative.eigenvalues().minCoeff(), 1.0 - 1e-9) << share;
    const Mat6 of_factor =
        odometryFactor(before, keyframeAt(1, kFirst, share * before.covariance)).covariance;
    const Eigen::GeneralizedSelfAdjointEigenSolver<Mat6> at_rest(of_factor, floor.covariance(0.0));
    EXPECT_GT(at_rest.eigenvalues().minCoeff(), 1.0 - 1e-9) << share;
  }
  // A rig at rest keeps a positive definite covariance.
  const Mat6 at_rest = odometryEdge(before, keyframeAt(1, kFirst, before.covariance)).covariance;
  EXPECT_LT(relativeDifference(at_rest, floor.covariance(0.0)), 1e-6);
}

TEST(OdometryFactor, IsTheEdgeWhereTheCovarianceGrows) {
  const RelativePose edge{kSecond, unequalCovariance()};
  const Mat6 before = 3.0 * unequalCovariance();
  const MapKeyframe first = keyframeAt(0, kFirst, before);
  const MapKeyframe next = keyframeAt(1, kFirst * kSecond, propagated(kFirst, before, edge));
  EXPECT_LT(relativeDifference(odometryFactor(first, next).covariance, odometryEdge(first, next).covariance),
            1e-9);
}

TEST(OdometryEdge, RefusesKeyframesThatOdometryDoesNotConnect) {
  const MapKeyframe first = keyframeAt(0, kFirst, unequalCovariance());
  MapKeyframe other = keyframeAt(1, kSecond, unequalCovariance());
  other.dive = 1;
  EXPECT_THROW(odometryEdge(first, other), InputError);
  MapKeyframe broken = keyframeAt(1, kSecond, Mat6::Constant(std::nan("")));
  EXPECT_THROW(odometryEdge(first, broken), InputError);
  OdometryFloor none;
  none.rotation_rad_per_sqrt_m = 0.0;
  EXPECT_THROW(odometryEdge(first, keyframeAt(1, kSecond, unequalCovariance()), 0.0, none), UsageError);
}

TEST(OdometryChain, AgreesWithTheCompositionOfItsEdges) {
  OdometryChain chain;
  chain.start(10, kFirst);
  std::vector<RelativePose> edges;
  for (int k = 0; k < 6; ++k) {
    edges.push_back({Rigid3(so3::exp(Vec3(0.1 * k, -0.2, 0.3)), Vec3(1, 0.2 * k, -0.3)),
                     (1.0 + k) * unequalCovariance()});
    chain.extend(11 + k, edges.back());
  }
  RelativePose expected = edges[1];
  for (int k = 2; k < 5; ++k) expected = composed(expected, edges[static_cast<size_t>(k)]);
  const RelativePose found = chain.relative(11, 15);
  EXPECT_LT(errorBetween(found.from_from_to, expected.from_from_to).norm(), 1e-12);
  EXPECT_LT(relativeDifference(found.covariance, expected.covariance), 1e-10);
  EXPECT_LT(relativeDifference(chain.relative(15, 11).covariance, inverted(expected).covariance), 1e-10);
  EXPECT_LT(chain.relative(13, 13).covariance.norm(), 1e-15);
  EXPECT_THROW(chain.relative(10, 99), InputError);
  EXPECT_THROW(chain.extend(12, edges[0]), InputError);
  EXPECT_THROW(OdometryChain().extend(1, edges[0]), InputError);
  EXPECT_EQ(chain.size(), 7U);  // a refused keyframe is not added
}

TEST(LevelMotion, KeepsRollAndPitchOfTheOdometry) {
  const Rigid3 odom_from_body(so3::exp(Vec3(0.3, -0.2, 2.0)), Vec3(10, 4, -3));
  const Rigid3 truth(Quat(Eigen::AngleAxisd(-2.5, Vec3::UnitZ())), Vec3(100, 50, -20));
  EXPECT_LT(errorBetween(mapFromOdom(truth * odom_from_body, odom_from_body), truth).norm(), 1e-10);
  // The graph corrects roll by 2 degrees: the position still agrees, and the motion stays level.
  Rigid3 corrected = truth * odom_from_body;
  corrected.rotation = so3::exp(Vec3(0.035, 0.0, 0.0)) * corrected.rotation;
  const Rigid3 level = mapFromOdom(corrected, odom_from_body);
  EXPECT_LT((level * odom_from_body.translation - corrected.translation).norm(), 1e-10);
  EXPECT_LT((level.rotation * Vec3::UnitZ() - Vec3::UnitZ()).norm(), 1e-12);
  EXPECT_NEAR(azimuthOf(level.rotation), -2.5, 1e-10);
}

TEST(LevelMotion, HasNoAzimuthAtHalfATurnAboutAHorizontalAxis) {
  EXPECT_EQ(azimuthOf(Quat(0, 1, 0, 0)), 0.0);
  EXPECT_NEAR(azimuthOf(Quat(Eigen::AngleAxisd(3.0, -Vec3::UnitZ()))), -3.0, 1e-12);
}

}  // namespace
}  // namespace lodeline

#include "lodeline/estimator/dvl/dvl_factor.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "lodeline/diagnostics.h"
#include "lodeline/factors/numeric_jacobian.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/imu/test_motion.h"

namespace lodeline {
namespace {

using PingBlocks = std::vector<Eigen::VectorXd>;

const Vec3 kPingGyroscopeBias(0.01, -0.02, 0.015);
const Vec3 kPingAccelerometerBias(0.05, 0.03, -0.04);
constexpr double kTrueScale = 0.012;
const Vec3 kTrueMisalignment(0.03, -0.04, 0.02);
const Vec3 kTrueCurrent_W(0.21, -0.13, 0.04);
constexpr double kPing_s = 0.61, kFrame_s = 0.72;

/// A ping in the middle of a lively motion, 0.11 s before its frame.
struct PingScene {
  DvlTrack track = DvlTrack::Bottom;
  TestMotion truth = {};
  Rigid3 body_from_dvl{so3::exp(Vec3(2.9, 0.2, -0.4)), Vec3(-0.4, 0.15, -0.25)};

  /// Integrated with biases that are off.
  DvlGeometry geometry() const {
    const Vec3 gyroscope_bias = kPingGyroscopeBias + Vec3(1e-3, 2e-3, -1e-3);
    const Vec3 accelerometer_bias = kPingAccelerometerBias + Vec3(0.02, -0.03, 0.01);
    const auto samples =
        truth.readings(kPing_s, kFrame_s, 1000.0, kPingGyroscopeBias, kPingAccelerometerBias);
    const Preintegration interval(samples, gyroscope_bias, accelerometer_bias, ImuCalibration());
    return {body_from_dvl, standardGravity_W(), PingMotion(interval, samples.front().angular_velocity_B),
            track};
  }
  /// What the instrument shows, from the true motion at the ping.
  Vec3 shown_D() const {
    const Vec3 current_W = track == DvlTrack::Water ? kTrueCurrent_W : Vec3::Zero();
    const Vec3 instrument_B = truth.rotation(kPing_s).conjugate() * (truth.velocity(kPing_s) - current_W) +
                              truth.rate_B(kPing_s).cross(body_from_dvl.translation);
    return (1.0 + kTrueScale) *
           ((body_from_dvl.rotation * so3::exp(kTrueMisalignment)).conjugate() * instrument_B);
  }
  PingBlocks blocks() const {
    const Time frame = Time::fromSeconds(kFrame_s);
    Eigen::VectorXd motion(kMotionSize);
    motion << truth.velocity(kFrame_s), kPingGyroscopeBias, kPingAccelerometerBias;
    PingBlocks blocks = {poseVector(truth.state(frame).world_from_body), motion,
                         Eigen::VectorXd::Constant(1, kTrueScale), kTrueMisalignment};
    if (track == DvlTrack::Water) blocks.push_back(kTrueCurrent_W);
    return blocks;
  }
};

double dvlResidual(const DvlFactor& factor, const PingBlocks& blocks) {
  std::vector<const double*> pointers;
  for (const auto& block : blocks) pointers.push_back(block.data());
  double residual = 0.0;
  EXPECT_TRUE(factor.Evaluate(pointers.data(), &residual, nullptr));
  return residual;
}

PingBlocks disturbedPing(PingBlocks blocks) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0.0, 0.01);
  Eigen::Matrix<double, 6, 1> step;
  for (double& s : step) s = normal(random);
  blocks[0] = poseVector(perturbed(poseFromBlock(blocks[0].data()), step));
  for (size_t i = 1; i < blocks.size(); ++i) {
    for (double& value : blocks[i]) value += normal(random);
  }
  return blocks;
}

std::vector<Vec3> beamsAndAxes() {
  std::vector<Vec3> all = DvlCalibration::janusBeams_D(0.39);
  all.insert(all.end(), {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()});
  return all;
}

constexpr DvlTrack kTracks[] = {DvlTrack::Bottom, DvlTrack::Water};

TEST(DvlFactor, IsZeroAtTheTruth) {
  for (const DvlTrack track : kTracks) {
    const PingScene scene{track};
    for (const Vec3& direction : beamsAndAxes()) {
      const DvlFactor factor(direction, direction.dot(scene.shown_D()), 1.0, scene.geometry());
      EXPECT_NEAR(dvlResidual(factor, scene.blocks()), 0.0, 1e-4) << direction.transpose();
    }
  }
}

TEST(DvlFactor, LeverArmGravityAndStatesMatter) {
  const PingScene scene{DvlTrack::Water};
  const Vec3 direction(0.6, 0.48, 0.64);
  const double shown = direction.dot(scene.shown_D());
  DvlGeometry without_arm = scene.geometry(), weightless = scene.geometry();
  without_arm.body_from_dvl.translation.setZero();
  weightless.gravity_W.setZero();
  EXPECT_GT(std::abs(dvlResidual({direction, shown, 1.0, without_arm}, scene.blocks())), 0.01);
  EXPECT_GT(std::abs(dvlResidual({direction, shown, 1.0, weightless}, scene.blocks())), 0.1);
  for (const size_t state : {2, 3, 4}) {
    PingBlocks blocks = scene.blocks();
    blocks[state].setZero();
    EXPECT_GT(std::abs(dvlResidual({direction, shown, 1.0, scene.geometry()}, blocks)), 0.005) << state;
  }
}

TEST(DvlFactor, JacobiansAgreeWithNumericDifferentiation) {
  for (const DvlTrack track : kTracks) {
    const PingScene scene{track};
    for (const Vec3& direction : beamsAndAxes())
      expectJacobiansMatch(DvlFactor(direction, 0.3, 0.01, scene.geometry()), disturbedPing(scene.blocks()));
  }
}

TEST(DvlFactor, JacobiansAgreeForAPingAtTheFrame) {
  for (const DvlTrack track : kTracks) {
    const PingScene scene{track};
    DvlGeometry geometry = scene.geometry();
    geometry.motion = PingMotion();
    geometry.motion.rate_B = Vec3(0.3, -0.5, 0.2);
    expectJacobiansMatch(DvlFactor(Vec3(0.6, 0.48, 0.64), 0.3, 0.01, geometry),
                         disturbedPing(scene.blocks()));
  }
}

TEST(DvlFactor, HasUnitVarianceUnderItsNoise) {
  const PingScene scene{DvlTrack::Water};
  const Vec3 direction(0.6, -0.48, 0.64);
  const double shown = direction.dot(scene.shown_D());
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.02);
  const DvlGeometry geometry = scene.geometry();
  double squares = 0.0;
  constexpr int kRuns = 2000;
  for (int i = 0; i < kRuns; ++i)
    squares += std::pow(dvlResidual({direction, shown + noise(random), 0.02, geometry}, scene.blocks()), 2);
  EXPECT_NEAR(squares / kRuns, 1.0, 0.1);
}

TEST(DvlFactor, SeesNeitherPlaceNorHeadingOfTheWorld) {
  const PingScene scene{DvlTrack::Water};
  const DvlFactor factor(Vec3(0.6, 0.48, 0.64), 0.3, 0.01, scene.geometry());
  PingBlocks blocks = disturbedPing(scene.blocks());
  const double before = dvlResidual(factor, blocks);
  const Rigid3 motion(so3::exp(Vec3(0.0, 0.0, 1.3)), Vec3(4.0, -7.0, 2.0));
  blocks[0] = poseVector(motion * poseFromBlock(blocks[0].data()));
  blocks[1].head<3>() = motion.rotation * Vec3(blocks[1].head<3>());
  blocks[4] = motion.rotation * Vec3(blocks[4]);
  EXPECT_NEAR(dvlResidual(factor, blocks), before, 1e-9);
  const Rigid3 tilt(so3::exp(Vec3(0.3, 0.0, 0.0)), Vec3::Zero());
  blocks[0] = poseVector(tilt * poseFromBlock(blocks[0].data()));
  blocks[1].head<3>() = tilt.rotation * Vec3(blocks[1].head<3>());
  blocks[4] = tilt.rotation * Vec3(blocks[4]);
  EXPECT_GT(std::abs(dvlResidual(factor, blocks) - before), 1.0) << "gravity tells tilt";
}

// Water that moves with the vehicle: one velocity more of both changes nothing.
TEST(DvlFactor, SeesOnlyTheVelocityThroughTheWater) {
  const PingScene scene{DvlTrack::Water};
  const DvlFactor factor(Vec3(0.6, 0.48, 0.64), 0.3, 0.01, scene.geometry());
  PingBlocks blocks = disturbedPing(scene.blocks());
  const double before = dvlResidual(factor, blocks);
  const Vec3 more(0.3, 0.5, -0.2);
  blocks[1].head<3>() += more;
  EXPECT_GT(std::abs(dvlResidual(factor, blocks) - before), 1.0);
  blocks[4] += more;
  EXPECT_NEAR(dvlResidual(factor, blocks), before, 1e-9);
}

// The Jacobian at the linearization points has the null space of the residual, whatever the present values.
TEST(DvlFactor, KeepsTheHeadingUnobservableAtLinearizationPoints) {
  const PingScene scene{DvlTrack::Water};
  const PingBlocks first = disturbedPing(scene.blocks()), now = scene.blocks();
  const DvlFactor factor(
      Vec3(0.6, 0.48, 0.64), 0.3, 0.01, scene.geometry(),
      {first[0].data(), first[1].data(), first[2].data(), first[3].data(), first[4].data()});
  std::vector<const double*> pointers;
  for (const auto& block : now) pointers.push_back(block.data());
  Eigen::VectorXd by_pose(kPoseSize), by_motion(kMotionSize);
  Vec3 by_current;
  double* jacobians[] = {by_pose.data(), by_motion.data(), nullptr, nullptr, by_current.data()};
  double residual = 0.0;
  ASSERT_TRUE(factor.Evaluate(pointers.data(), &residual, jacobians));
  const double turn = by_pose[5] + by_motion.head<3>().dot(Vec3::UnitZ().cross(Vec3(first[1].head<3>()))) +
                      by_current.dot(Vec3::UnitZ().cross(Vec3(first[4])));
  EXPECT_GT(by_motion.norm(), 1.0);
  EXPECT_LT(std::abs(turn), 1e-9 * by_motion.norm());
  EXPECT_EQ(by_pose.head<3>().norm(), 0.0);
}

TEST(DvlFactor, RefusesWhatCannotBeWeighed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const DvlGeometry geometry;
  for (const double sigma : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()})
    EXPECT_THROW(DvlFactor(Vec3::UnitX(), 0.1, sigma, geometry), InputError) << sigma;
  EXPECT_THROW(DvlFactor(Vec3::UnitX(), nan, 0.01, geometry), InputError);
  EXPECT_THROW(DvlFactor(Vec3::Constant(nan), 0.1, 0.01, geometry), InputError);
}

}  // namespace
}  // namespace lodeline

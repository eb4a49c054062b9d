#include "lodeline/factors/sensors/magnetometer_relative_factor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lodeline/diagnostics.h"
#include "lodeline/factors/numeric_jacobian.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

using Blocks = std::vector<Eigen::VectorXd>;

const Vec3 kField_W(1e-6, 24e-6, -38e-6);
const Rigid3 kPoseK(so3::exp(Vec3(0.3, -0.4, 2.0)), Vec3(3.0, -2.0, 1.0));
const Vec3 kTurn_B(0.05, -0.1, 0.2);
const Rigid3 kPoseK1(kPoseK.rotation* so3::exp(kTurn_B), Vec3(3.1, -2.0, 1.0));
constexpr double kSigma_T = 0.1e-6;
constexpr int kReadings = 5;

// The rig turns at a constant rate from k to k+1: the preintegrated rotation to reading j of n.
Quat gamma(int j) { return so3::exp(kTurn_B * (static_cast<double>(j) / kReadings)); }

class Interval {
 public:
  explicit Interval(double sigma_T = 0.0, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    for (int j = 1; j <= kReadings; ++j) {
      const Vec3 noise(normal(random), normal(random), normal(random));
      readings_.push_back((kPoseK.rotation * gamma(j)).conjugate() * kField_W + sigma_T * noise);
    }
  }
  // The sum over readings, exactly as the paper prints it.
  double printedCost(const Blocks& blocks) const {
    const Quat k_from_k1 =
        poseFromBlock(blocks[0].data()).rotation.conjugate() * poseFromBlock(blocks[1].data()).rotation;
    double cost = 0.0;
    for (int j = 1; j <= kReadings; ++j)
      cost += ((k_from_k1 * readings_.back() - gamma(j) * readings_[j - 1]) / kSigma_T).squaredNorm();
    return cost;
  }
  MagnetometerRelativeFactor factor(const double* first_k = nullptr, const double* first_k1 = nullptr) const {
    Vec3 mean = Vec3::Zero();
    for (int j = 1; j <= kReadings; ++j) mean += gamma(j) * readings_[j - 1] / kReadings;
    return {readings_.back(), mean, kReadings, kSigma_T, first_k, first_k1};
  }

 private:
  std::vector<Vec3> readings_;
};

Vec3 residualOf(const MagnetometerRelativeFactor& factor, const Blocks& blocks) {
  const double* pointers[] = {blocks[0].data(), blocks[1].data()};
  Vec3 residual;
  EXPECT_TRUE(factor.Evaluate(pointers, residual.data(), nullptr));
  return residual;
}

Blocks trueBlocks() { return {poseVector(kPoseK), poseVector(kPoseK1)}; }

Blocks moved(const Vec3& k, const Vec3& k1) {
  return {poseVector(Rigid3(so3::exp(k) * kPoseK.rotation, kPoseK.translation)),
          poseVector(Rigid3(so3::exp(k1) * kPoseK1.rotation, kPoseK1.translation))};
}

TEST(MagnetometerRelativeFactor, IsZeroAtTheTruth) {
  EXPECT_LT(residualOf(Interval().factor(), trueBlocks()).norm(), 1e-6);
}

TEST(MagnetometerRelativeFactor, IsTheSumOfThePrintedResidualsUpToAConstant) {
  const Interval interval(1e-6);
  const MagnetometerRelativeFactor factor = interval.factor();
  const double constant = interval.printedCost(trueBlocks()) - residualOf(factor, trueBlocks()).squaredNorm();
  for (const Vec3& turn : {Vec3(0.1, 0.0, 0.0), Vec3(-0.02, 0.05, 0.3), Vec3(0.0, 0.0, -1.0)}) {
    const Blocks blocks = moved(turn, -0.5 * turn);
    const double cost = residualOf(factor, blocks).squaredNorm() + constant;
    EXPECT_NEAR(cost, interval.printedCost(blocks), 1e-9 * cost);
  }
}

TEST(MagnetometerRelativeFactor, JacobiansAgreeWithNumericDifferentiation) {
  expectJacobiansMatch(Interval(1e-6).factor(), moved(Vec3(0.1, 0.2, -0.1), Vec3(0.0, -0.1, 0.05)));
}

// The weights are the sensor's noise alone and count the shared reading n times: with every reading noisy,
// the term's mean square is that of n independent residuals only if m^{k+1} were exact.
TEST(MagnetometerRelativeFactor, WhitensOnlyTheReadingsBesideTheSharedOne) {
  constexpr int kRuns = 4000;
  double squares = 0.0;
  for (int run = 0; run < kRuns; ++run)
    squares += residualOf(Interval(kSigma_T, run + 1).factor(), trueBlocks()).squaredNorm();
  // sqrt(n) (m_n - mean) / sigma: variance n (1 - 1/n) per axis, far from 1.
  const double expected = 3.0 * (kReadings - 1);
  EXPECT_NEAR(squares / kRuns / expected, 1.0, 4.0 * std::sqrt(2.0 / (3.0 * kRuns)));
}

TEST(MagnetometerRelativeFactor, TurningTheWorldChangesNothing) {
  const MagnetometerRelativeFactor factor = Interval(1e-6).factor();
  const Rigid3 other_from_world(so3::exp(Vec3(0.4, -1.0, 2.0)), Vec3(1.0, 2.0, 3.0));
  const Blocks other = {poseVector(other_from_world * kPoseK), poseVector(other_from_world * kPoseK1)};
  EXPECT_LT((residualOf(factor, other) - residualOf(factor, trueBlocks())).norm(), 1e-9);
}

TEST(MagnetometerRelativeFactor, LinearizationPointsKeepTheYawOfTheWorldUnobservable) {
  const Blocks first = moved(Vec3(0.02, 0.01, 0.1), Vec3(-0.01, 0.02, 0.05));
  const MagnetometerRelativeFactor factor = Interval(1e-6).factor(first[0].data(), first[1].data());
  Eigen::Matrix<double, 3, kPoseSize, Eigen::RowMajor> by_k, by_k1;
  double* jacobians[] = {by_k.data(), by_k1.data()};
  const Blocks blocks = trueBlocks();
  const double* pointers[] = {blocks[0].data(), blocks[1].data()};
  Vec3 residual;
  ASSERT_TRUE(factor.Evaluate(pointers, residual.data(), jacobians));
  EXPECT_LT((by_k + by_k1).norm(), 1e-12 * by_k.norm());
}

TEST(MagnetometerRelativeFactor, RefusesWhatCannotBeWeighed) {
  EXPECT_THROW(MagnetometerRelativeFactor(kField_W, kField_W, 0, kSigma_T), InputError);
  EXPECT_THROW(MagnetometerRelativeFactor(kField_W, kField_W, 3, 0.0), InputError);
  EXPECT_THROW(MagnetometerRelativeFactor(kField_W / 0.0, kField_W, 3, kSigma_T), InputError);
}

}  // namespace
}  // namespace lodeline

#include "lodeline/magnetometer/field_map/potential_basis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

Eigen::VectorXd drawnWeights(const PotentialBasis& basis, uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd weights(basis.size());
  for (int j = 0; j < basis.size(); ++j) weights[j] = std::sqrt(basis.weightVariances()[j]) * normal(random);
  return weights;
}

TEST(PotentialBasis, FieldIsAGradientWithoutCurl) {
  const PotentialBasis basis(4.5, 1.5, 6e-6);
  const Eigen::VectorXd weights = drawnWeights(basis, 3);
  constexpr double kStep_m = 1e-4;
  for (const Vec3& place : {Vec3(0.0, 0.0, 0.0), Vec3(1.2, -2.0, 0.7), Vec3(-3.1, 2.9, -2.2)}) {
    Mat3 numeric;
    for (int d = 0; d < 3; ++d) {
      const Vec3 step = kStep_m * Vec3::Unit(d);
      numeric.col(d) =
          (basis.gradients(place + step) - basis.gradients(place - step)) * weights / (2.0 * kStep_m);
    }
    const Mat3 analytic = basis.fieldByPoint(place, weights);
    EXPECT_LT((numeric - analytic).norm(), 1e-5 * analytic.norm());
    EXPECT_LT((numeric - numeric.transpose()).norm(), 1e-5 * analytic.norm());
  }
}

TEST(PotentialBasis, PriorHasTheStatedSigmaAndLengthScale) {
  constexpr double kLength_m = 1.5, kSigma_T = 6e-6;
  const PotentialBasis basis(3.0 * kLength_m, kLength_m, kSigma_T);
  const auto covariance = [&](const Vec3& a, const Vec3& b) -> Mat3 {
    return basis.gradients(a) * basis.weightVariances().asDiagonal() * basis.gradients(b).transpose();
  };
  // Less than the whole variance, since the spectrum is cut off.
  for (const Vec3& place : {Vec3(0.0, 0.0, 0.0), Vec3(1.0, -1.5, 0.3)}) {
    const Vec3 share = covariance(place, place).diagonal() / (kSigma_T * kSigma_T);
    EXPECT_GT(share.minCoeff(), 0.75);
    EXPECT_LT(share.maxCoeff(), 1.05);
  }
  // Covariance of the gradient of a squared exponential potential: along and across the distance r,
  // s^2 / l^2 (1 - r^2 / l^2) exp(-r^2 / 2 l^2) and s^2 / l^2 exp(-r^2 / 2 l^2).
  const double r_m = 1.0, share = r_m / kLength_m, decay = std::exp(-0.5 * share * share);
  const Mat3 apart =
      covariance(Vec3(-0.5 * r_m, 0.0, 0.0), Vec3(0.5 * r_m, 0.0, 0.0)) / (kSigma_T * kSigma_T);
  EXPECT_NEAR(apart(0, 0), (1.0 - share * share) * decay, 0.08);
  EXPECT_NEAR(apart(1, 1), decay, 0.1);
  EXPECT_NEAR(apart(2, 2), decay, 0.1);
  EXPECT_NEAR(apart(0, 1), 0.0, 1e-9);
}

TEST(PotentialBasis, SizeFollowsTheBoxInLengthScales) {
  const int size = PotentialBasis(4.5, 1.5, 6e-6).size();
  EXPECT_GT(size, 40);
  EXPECT_LT(size, 150);
  EXPECT_EQ(PotentialBasis(6.0, 2.0, 1e-6).size(), size);
  EXPECT_GT(PotentialBasis(6.0, 1.5, 6e-6).size(), size);
}

TEST(PotentialBasis, RefusesAFormThatDoesNotExist) {
  EXPECT_THROW(PotentialBasis(4.5, 0.0, 1e-6), UsageError);
  EXPECT_THROW(PotentialBasis(4.5, 1.5, -1e-6), UsageError);
  EXPECT_THROW(PotentialBasis(1.0, 1.5, 1e-6), UsageError);
  EXPECT_THROW(PotentialBasis(4.5, std::nan(""), 1e-6), UsageError);
}

}  // namespace
}  // namespace lodeline

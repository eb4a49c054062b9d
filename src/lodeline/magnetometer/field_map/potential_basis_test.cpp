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

/// Covariance of the field of a process at the distance r along x, in units of its variance: along and across
/// x. `cut_off`: its spectrum has no higher angular frequencies, in units of 1 / l. `r`: in units of l. The
/// integral over the spectrum is a sum over spheres, and over the angle to x.
Vec2 covarianceOfCutSpectrum(double r, double cut_off) {
  constexpr int kSteps = 400;
  Vec2 sum = Vec2::Zero();
  for (int i = 0; i < kSteps; ++i) {
    const double rate = (i + 0.5) * cut_off / kSteps;
    const double sphere = std::pow(rate, 4) * std::exp(-0.5 * rate * rate) * cut_off / kSteps;
    for (int j = 0; j < kSteps; ++j) {
      const double cosine = -1.0 + (j + 0.5) * 2.0 / kSteps;
      const Vec2 axes(cosine * cosine, 0.5 * (1.0 - cosine * cosine));
      sum += sphere * axes * std::cos(rate * cosine * r) * (2.0 / kSteps);
    }
  }
  return sum / std::sqrt(2.0 * M_PI);
}

TEST(PotentialBasis, PriorHasTheStatedSigmaAndLengthScaleButForTheCutOff) {
  constexpr double kLength_m = 1.5, kSigma_T = 6e-6;
  const PotentialBasis basis(3.0 * kLength_m, kLength_m, kSigma_T);
  const auto covariance = [&](const Vec3& a, const Vec3& b) -> Mat3 {
    return basis.gradients(a) * basis.weightVariances().asDiagonal() * basis.gradients(b).transpose() /
           (kSigma_T * kSigma_T);
  };
  const double variance = covarianceOfCutSpectrum(0.0, PotentialBasis::kCutOff).x();
  EXPECT_NEAR(variance, 0.89, 0.005) << "as its header says";
  for (const Vec3& place : {Vec3(0.0, 0.0, 0.0), Vec3(1.0, -1.5, 0.3)}) {
    for (const double share : Vec3(covariance(place, place).diagonal())) EXPECT_NEAR(share, variance, 0.03);
  }
  constexpr double kApart_m = 1.0, kApart = kApart_m / kLength_m;
  const Vec2 expected = covarianceOfCutSpectrum(kApart, PotentialBasis::kCutOff);
  const Mat3 apart = covariance(Vec3(-0.5 * kApart_m, 0.0, 0.0), Vec3(0.5 * kApart_m, 0.0, 0.0));
  EXPECT_NEAR(apart(0, 0), expected.x(), 0.012);
  EXPECT_NEAR(apart(1, 1), expected.y(), 0.012);
  EXPECT_NEAR(apart(2, 2), expected.y(), 0.012);
  EXPECT_NEAR(apart(0, 1), 0.0, 1e-9);
  // The covariance of the gradient of a squared exponential potential, without a cut: along and across,
  // (1 - r^2) exp(-r^2 / 2) and exp(-r^2 / 2).
  const double decay = std::exp(-0.5 * kApart * kApart);
  const Vec2 whole = covarianceOfCutSpectrum(kApart, 9.0);
  EXPECT_NEAR(whole.x(), (1.0 - kApart * kApart) * decay, 1e-3);
  EXPECT_NEAR(whole.y(), decay, 1e-3);
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

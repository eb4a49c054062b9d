#include "lodeline/magnetometer/iron/iron_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "lodeline/magnetometer/iron/ellipsoid_fit.h"
#include "lodeline/magnetometer/iron/test_cloud.h"

namespace lodeline {
namespace {

using test::cloud;
using test::CloudTruth;
using Vec9 = Eigen::Matrix<double, 9, 1>;

IronParameters startFrom(const std::vector<Vec3>& readings) {
  const auto ellipsoid = fitEllipsoid(readings);
  return {ellipsoid->matrix, ellipsoid->centre};
}

Vec9 errorOf(const IronParameters& estimate, const CloudTruth& truth) {
  Vec9 error;
  error << symmetricEntries(estimate.correction - truth.correction), estimate.hard_iron - truth.hard_iron;
  return error;
}

TEST(IronResidual, IsZeroAtTheTruth) {
  const CloudTruth truth;
  for (const Vec3& reading : cloud(truth, 50)) {
    EXPECT_NEAR(ironResidual(reading, {truth.correction, truth.hard_iron}).distance, 0.0, 1e-14);
  }
}

TEST(IronResidual, JacobianIsThatOfTheNormWithTheWeightHeld) {
  const CloudTruth truth;
  const Vec3 reading(1.1, 0.4, -0.3);
  const IronParameters at{truth.correction, truth.hard_iron};
  const IronResidual r = ironResidual(reading, at);
  const auto norm = [&](const Vec9& step) {
    return ((at.correction + symmetricMatrix(step.head<6>())) * (reading - at.hard_iron - step.tail<3>()))
        .norm();
  };
  const double weight = r.distance / (norm(Vec9::Zero()) - 1.0);
  for (int i = 0; i < 9; ++i) {
    Vec9 step = Vec9::Zero();
    step[i] = 1e-6;
    EXPECT_NEAR(r.jacobian[i], weight * (norm(step) - norm(-step)) / 2e-6, 1e-8) << i;
  }
}

TEST(IronResidual, HasTheStandardDeviationOfTheReadingsWhateverTheSoftIron) {
  CloudTruth truth;
  truth.correction = Vec3(0.4, 1.0, 2.5).asDiagonal();
  truth.sigma = 1e-3;
  double square = 0.0;
  const std::vector<Vec3> readings = cloud(truth, 20000);
  for (const Vec3& reading : readings) {
    square += std::pow(ironResidual(reading, {truth.correction, truth.hard_iron}).distance / truth.sigma, 2);
  }
  EXPECT_NEAR(square / 20000.0, 1.0, 0.03);
}

TEST(IronFit, ErrorsAgreeWithTheirCovariance) {
  constexpr int kRuns = 60;
  double sum = 0.0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    CloudTruth truth;
    truth.sigma = 0.004;
    truth.seed = seed;
    const std::vector<Vec3> readings = cloud(truth, 300);
    const IronFit fit = fitIron(readings, startFrom(readings), {});
    const Vec9 error = errorOf(fit.parameters, truth);
    sum += error.dot(fit.covariance.ldlt().solve(error));
    EXPECT_NEAR(fit.sigma, truth.sigma, 0.15 * truth.sigma);
  }
  // The mean of chi-square with 9 degrees of freedom over the runs: 9 +- 3 sigma.
  EXPECT_NEAR(sum / kRuns, 9.0, 3.0 * std::sqrt(18.0 / kRuns));
}

TEST(IronFit, LeavesOutliersOut) {
  CloudTruth truth;
  truth.sigma = 0.003;
  std::vector<Vec3> readings = cloud(truth, 400);
  for (size_t i = 0; i < readings.size(); i += 10) readings[i] += Vec3(0.15, 0.2, -0.1);
  const IronFit fit = fitIron(readings, startFrom(readings), {});
  int outliers_used = 0, others_used = 0;
  for (size_t i = 0; i < readings.size(); ++i) (i % 10 == 0 ? outliers_used : others_used) += fit.used[i];
  EXPECT_LE(outliers_used, 8);  // outliers moved along the surface cannot be detected
  EXPECT_GE(others_used, 355);
  EXPECT_LT((fit.parameters.hard_iron - truth.hard_iron).norm(), 0.01);
}

TEST(IronFit, WidensTheCovarianceForWhatTheModelLeavesOut) {
  CloudTruth truth;
  truth.sigma = 1e-4;
  truth.correction = Mat3::Identity();
  truth.least_cosine = 0.3;
  const std::vector<Vec3> readings = cloud(truth, 300);
  IronFitOptions options;
  options.model = IronModel::Scale;
  const IronFit fit = fitIron(readings, {Mat3::Identity(), truth.hard_iron}, options);
  // 2 to 3 % of unknown soft iron affect the offset of a sensor with partial coverage.
  EXPECT_GT(std::sqrt(fit.covariance(6, 6)), 0.01);
  options.left_out_scale_sigma = options.left_out_skew_sigma = 0.0;
  EXPECT_LT(std::sqrt(fitIron(readings, {Mat3::Identity(), truth.hard_iron}, options).covariance(6, 6)),
            1e-4);
}

TEST(IronFit, TellsBadGeometryByTheConditionNumber) {
  CloudTruth truth;
  truth.sigma = 1e-3;
  const IronParameters start{truth.correction, truth.hard_iron};
  EXPECT_LT(fitIron(cloud(truth, 300), start, {}).condition_number, 50.0);
  truth.least_cosine = 0.9;
  EXPECT_GT(fitIron(cloud(truth, 300), start, {}).condition_number, 1e4);
}

TEST(CorrelationFactor, IsOneForIndependentValuesAndCountsSlowOnes) {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  std::vector<double> white, slow;
  double value = 0.0;
  for (int i = 0; i < 20000; ++i) {
    white.push_back(normal(engine));
    value = 0.9 * value + normal(engine);
    slow.push_back(value);
  }
  EXPECT_NEAR(correlationFactor(white), 1.0, 0.05);
  EXPECT_NEAR(correlationFactor(slow), 19.0, 4.0);  // (1 + 0.9) / (1 - 0.9)
}

}  // namespace
}  // namespace lodeline

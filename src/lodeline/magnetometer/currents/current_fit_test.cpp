#include "lodeline/magnetometer/currents/current_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "lodeline/magnetometer/currents/test_still_test.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

using test::makeStillTest;
using test::StillTestOptions;
using ::testing::HasSubstr;
using ::testing::StartsWith;

Eigen::MatrixXd errorsOf(const CurrentFit& fit, const StillTestOptions& options) {
  Eigen::MatrixXd errors = fit.fields_T_per_A();
  for (size_t i = 0; i < fit.channels.size(); ++i)
    errors.row(static_cast<Eigen::Index>(i)) -= options.fields_T_per_A[i].transpose();
  return errors;
}

CurrentFit fitOf(const StillTestOptions& options, Diagnostics* diagnostics = nullptr) {
  Diagnostics unseen;
  return fitCurrents(makeStillTest(options), diagnostics ? diagnostics : &unseen);
}

std::string refusalOf(const StillTest& still) {
  Diagnostics diagnostics;
  try {
    fitCurrents(still, &diagnostics);
  } catch (const EstimationError& error) {
    return error.what();
  }
  return "";
}

TEST(CurrentFit, FindsTheFieldsWithinTheirSigmas) {
  constexpr int kSeeds = 8;
  double chi_square = 0.0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    StillTestOptions options;
    options.seed = seed;
    const CurrentFit fit = fitOf(options);
    const Eigen::MatrixXd errors = 1e6 * errorsOf(fit, options);
    chi_square += (errors.transpose() * (1e12 * fit.covariance).ldlt().solve(errors)).trace();
    EXPECT_TRUE(fit.isComplete());
    EXPECT_THAT(fit.verdict, StartsWith("Good"));
    EXPECT_LT(errors.cwiseAbs().maxCoeff(), 0.02);
  }
  // Mean of chi-square with 12 degrees of freedom; the sigmas may be too large by the correlation's estimate.
  EXPECT_GT(chi_square / kSeeds, 5.0);
  EXPECT_LT(chi_square / kSeeds, 12.0 + 3.0 * std::sqrt(24.0 / kSeeds));
}

TEST(CurrentFit, TellsTheResidualBeforeAndAfter) {
  const CurrentFit fit = fitOf({});
  EXPECT_GT(fit.without.rms_T, 2e-6);
  EXPECT_GT(fit.without.heading_largest_rad, 10.0 * kDegree);
  EXPECT_LT(fit.with.rms_T, 0.15e-6);
  EXPECT_LT(fit.correlated_rms_rad, 0.1 * kDegree);
  EXPECT_NEAR(fit.channels[2].largestField_T(), 20.0 * 0.541e-6, 0.2e-6);
  EXPECT_NEAR(fit.rate_hz, 10.0, 0.01);
  // Two per cent of the fields.
  EXPECT_NEAR(fit.field_sigma_T_per_A, 0.02 * 0.24e-6, 0.002e-6);
}

TEST(CurrentFit, FindsTheLag) {
  for (const double lag_s : {0.22, -0.13}) {
    StillTestOptions options;
    options.lag_s = lag_s;
    const CurrentFit fit = fitOf(options);
    EXPECT_NEAR(fit.lag_s, lag_s, 0.01);
    EXPECT_NEAR(fit.measured_lag_s, lag_s, 5.0 * fit.lag_sigma_s);
    EXPECT_LT(errorsOf(fit, options).cwiseAbs().maxCoeff(), 0.02e-6);
  }
  EXPECT_NEAR(fitOf({}).measured_lag_s, 0.0, 0.01);
}

TEST(CurrentFit, NamesAChannelThatNeverRuns) {
  StillTestOptions options;
  options.largest_A[1] = 0.0;
  const CurrentFit fit = fitOf(options);
  EXPECT_THAT(fit.channels[1].objection, HasSubstr("hardly changes"));
  EXPECT_EQ(fit.channels[1].field_T_per_A.norm(), 0.0);
  EXPECT_GT(fit.channels[1].sigma_T_per_A, 0.2e-6);
  EXPECT_TRUE(fit.channels[0].isIdentified());
  EXPECT_THAT(fit.verdict, StartsWith("Usable"));
  EXPECT_THAT(fit.verdict, HasSubstr("motor_2"));
  for (double& largest_A : options.largest_A) largest_A = 0.0;
  EXPECT_THAT(refusalOf(makeStillTest(options)), HasSubstr("ramp each channel"));
}

TEST(CurrentFit, NamesChannelsThatRunTogether) {
  StillTestOptions options;
  options.together = true;
  const CurrentFit fit = fitOf(options);
  EXPECT_THAT(fit.channels[0].objection, HasSubstr("together with motor_2"));
  EXPECT_THAT(fit.channels[1].objection, HasSubstr("together with motor_1"));
  EXPECT_TRUE(fit.channels[2].isIdentified());
  // Their sum is known all the same.
  const Vec3 sum = options.fields_T_per_A[0] + options.fields_T_per_A[1];
  EXPECT_LT((fit.channels[0].field_T_per_A + fit.channels[1].field_T_per_A - sum).norm(), 0.02e-6);
  EXPECT_LT(fit.correlated_rms_rad, 0.1 * kDegree);
}

TEST(CurrentFit, AcceptsABatteryThatCarriesTheSum) {
  StillTestOptions options;
  options.battery = true;
  options.noise_T = 0.8e-6;  // of a consumer sensor
  const CurrentFit fit = fitOf(options);
  EXPECT_TRUE(fit.isComplete()) << fit.verdict;
  EXPECT_GT(fit.channels[3].sigma_T_per_A * fit.channels[3].largest_A, 0.2e-6) << "known alone too?";
  const Vec3 sum = options.fields_T_per_A[0] + options.fields_T_per_A[3];
  EXPECT_LT((fit.channels[0].field_T_per_A + fit.channels[3].field_T_per_A - sum).norm(), 0.02e-6);
}

TEST(CurrentFit, TakesOutASmallMotionAndRefusesALargeOne) {
  StillTestOptions options;
  options.sway_rad = 1.0 * kDegree;
  Diagnostics diagnostics;
  const CurrentFit fit = fitOf(options, &diagnostics);
  EXPECT_EQ(diagnostics.count("current_test_moved"), 1);
  EXPECT_NEAR(fit.turned_rad, options.sway_rad, 0.3 * kDegree);
  EXPECT_LT(errorsOf(fit, options).cwiseAbs().maxCoeff(), 0.03e-6);
  options.with_imu = false;
  const CurrentFit blind = fitOf(options, &diagnostics);
  EXPECT_EQ(diagnostics.count("current_test_motion_unknown"), 1);
  EXPECT_GT(blind.with.rms_T, 2.0 * fit.with.rms_T) << "this motion disturbs nobody";
  options.with_imu = true;
  options.sway_rad = 12.0 * kDegree;
  EXPECT_THAT(refusalOf(makeStillTest(options)), HasSubstr("turned by"));
}

TEST(CurrentFit, IsNotMovedBySpikes) {
  StillTestOptions options;
  options.spike_share = 0.03;
  const CurrentFit fit = fitOf(options);
  EXPECT_LT(errorsOf(fit, options).cwiseAbs().maxCoeff(), 0.02e-6);
  EXPECT_NEAR(fit.rejected_share, 0.06, 0.02) << "rows are means of two readings";
}

TEST(CurrentFit, PassesOverSaturatedReadings) {
  StillTest still = makeStillTest({});
  for (MagnetometerSample& sample : still.magnetometer)
    sample.field_M.x() = std::min(sample.field_M.x(), 27e-6);
  Diagnostics diagnostics;
  const CurrentFit fit = fitCurrents(still, &diagnostics);
  EXPECT_EQ(diagnostics.count("magnetometer_saturated"), 1);
  EXPECT_LT(errorsOf(fit, {}).cwiseAbs().maxCoeff(), 0.05e-6);
}

TEST(CurrentFit, NeedsBothStreamsAtTheSameTime) {
  StillTest still = makeStillTest({});
  for (CurrentSample& sample : still.currents) sample.time = sample.time + Duration::fromSeconds(3600.0);
  EXPECT_THAT(refusalOf(still), HasSubstr("same time"));
  still = makeStillTest({});
  still.magnetometer.resize(50);
  EXPECT_THAT(refusalOf(still), HasSubstr("too few"));
}

}  // namespace
}  // namespace lodeline

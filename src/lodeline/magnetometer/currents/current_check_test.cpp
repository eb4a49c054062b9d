#include "lodeline/magnetometer/currents/current_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/magnetometer/currents/test_still_test.h"

namespace lodeline {
namespace {

using test::makeStillTest;
using test::StillTestOptions;
using ::testing::StartsWith;

CurrentFit fitOn(const StillTestOptions& options) {
  Diagnostics diagnostics;
  return fitCurrents(makeStillTest(options), &diagnostics);
}

CurrentCalibration calibrationOf(const CurrentFit& fit) {
  CurrentCalibration calibration;
  for (const CurrentChannel& channel : fit.channels) {
    calibration.channels.push_back(channel.name);
    calibration.fields_T_per_A.push_back(channel.field_T_per_A);
  }
  calibration.field_sigma_T_per_A = fit.field_sigma_T_per_A;
  return calibration;
}

TEST(CurrentCheck, HoldsOnAnotherDay) {
  const CurrentCalibration calibration = calibrationOf(fitOn({}));
  StillTestOptions second;
  for (second.seed = 2; second.seed < 5; ++second.seed) {
    const CurrentCheck check = checkCurrents(fitOn(second), calibration);
    EXPECT_FALSE(check.is_moved) << second.seed;
    EXPECT_THAT(check.verdict, StartsWith("Holds: nothing"));
  }
}

TEST(CurrentCheck, NoticesMovedCables) {
  StillTestOptions second;
  second.seed = 2;
  second.fields_T_per_A[0] += Vec3(0.1e-6, 0.1e-6, 0.0);
  const CurrentCheck check = checkCurrents(fitOn(second), calibrationOf(fitOn({})));
  EXPECT_TRUE(check.is_moved);
  EXPECT_THAT(check.verdict, StartsWith("Cables moved: do not use"));
  EXPECT_NEAR(check.differences_T_per_A[0].x(), 0.1e-6, 0.01e-6);
}

TEST(CurrentCheck, FindsChannelsByName) {
  const CurrentFit fit = fitOn({});
  CurrentCalibration calibration = calibrationOf(fit);
  std::swap(calibration.channels[0], calibration.channels[2]);
  std::swap(calibration.fields_T_per_A[0], calibration.fields_T_per_A[2]);
  EXPECT_FALSE(checkCurrents(fit, calibration).is_moved);
  calibration.channels[0] = "other";
  EXPECT_THROW(checkCurrents(fit, calibration), InputError);
  calibration.fields_T_per_A.clear();
  EXPECT_THROW(checkCurrents(fit, calibration), InputError);
}

}  // namespace
}  // namespace lodeline

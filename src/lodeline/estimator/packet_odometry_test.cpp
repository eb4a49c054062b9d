#include "lodeline/estimator/packet_odometry.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {

TEST(PacketOdometry, FollowsMorePointsWithAnImuThatMayNeverHaveBeenCalibrated) {
  Rig rig;
  EstimatorOptions options;
  const double limit = options.imu_axes.calibrated_below_rad_per_s_sqrtHz;
  rig.imu.noise.gyroscope_density_rad_per_s_sqrtHz = 0.9 * limit;
  const int calibrated = tracksFor(rig, options);
  rig.imu.noise.gyroscope_density_rad_per_s_sqrtHz = 1.1 * limit;
  EXPECT_GT(tracksFor(rig, options), calibrated);
  options.imu_axes.gyroscope_sigma = 0.0;
  EXPECT_EQ(tracksFor(rig, options), calibrated);
}

}  // namespace
}  // namespace lodeline

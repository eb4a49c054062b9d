#include "lodeline/estimator/packet_odometry.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {

TEST(PacketOdometry, FollowsMorePointsWithAnImuThatMayNeverHaveBeenCalibrated) {
  Rig rig;
  EstimatorOptions options;
  rig.imu.noise.axes_sigma = 0.001;
  const int calibrated = tracksFor(rig, options);
  rig.imu.noise.axes_sigma = 0.007;
  EXPECT_GT(tracksFor(rig, options), calibrated);
  options.imu_axes.gyroscope_sigma = 0.0;
  EXPECT_EQ(tracksFor(rig, options), calibrated);
}

}  // namespace
}  // namespace lodeline

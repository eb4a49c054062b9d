#include "lodeline/magnetometer/calibration/heading/gyroscope_path.h"

#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/imu/test_motion.h"

namespace lodeline {
namespace {

TEST(GyroscopePath, FollowsTheMotionBetweenReadings) {
  const TestMotion motion;
  const Vec3 bias(0.02, -0.01, 0.03);
  const std::vector<ImuSample> imu = motion.readings(0.0, 5.0, 400.0, bias);
  const GyroscopePath path(imu, bias);
  for (const double t : {0.0, 0.0011, 1.7773, 4.9999}) {
    const GyroscopePath::Point point = path.at(Time::fromSeconds(t));
    const Quat truth = motion.rotation(0.0).conjugate() * motion.rotation(t);
    EXPECT_LT(point.start_from_body.angularDistance(truth), 1e-4) << t;
    EXPECT_LT((point.rate_B - motion.rate_B(t)).norm(), 1e-3);
  }
  EXPECT_TRUE(path.covers(Time::fromSeconds(5.0)));
  EXPECT_FALSE(path.covers(Time::fromSeconds(5.1)));
}

TEST(GyroscopePath, KnowsHowABiasTurnsIt) {
  const TestMotion motion;
  const std::vector<ImuSample> imu = motion.readings(0.0, 3.0, 200.0);
  const GyroscopePath path(imu, Vec3::Zero());
  const Vec3 change(2e-5, -1e-5, 3e-5);
  const GyroscopePath moved(imu, change);
  const Time time = Time::fromSeconds(2.6012);
  const Vec3 turn = so3::log(path.at(time).start_from_body.conjugate() * moved.at(time).start_from_body);
  EXPECT_LT((turn - path.at(time).by_bias * change).norm(), 1e-3 * turn.norm());
}

TEST(GyroscopePath, CountsGaps) {
  std::vector<ImuSample> imu = TestMotion().readings(0.0, 2.0, 100.0);
  imu.erase(imu.begin() + 101, imu.begin() + 120);  // 1.00 to 1.20 s
  const GyroscopePath path(imu, Vec3::Zero());
  EXPECT_NEAR(path.gap_s(Time::fromSeconds(0.0), Time::fromSeconds(2.0)), 0.2, 1e-6);
  EXPECT_NEAR(path.gap_s(Time::fromSeconds(1.1), Time::fromSeconds(1.15)), 0.05, 1e-6);
  EXPECT_EQ(path.gap_s(Time::fromSeconds(0.2), Time::fromSeconds(0.9)), 0.0);
  EXPECT_THROW(GyroscopePath(std::span<const ImuSample>(imu.data(), 1), Vec3::Zero()), InputError);
}

}  // namespace
}  // namespace lodeline

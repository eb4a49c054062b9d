#include "lodeline_ros/conversions.h"

#include <gtest/gtest.h>

#include "lodeline/factors/parameters.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

FrameEstimate someEstimate() {
  FrameEstimate estimate;
  estimate.time = Time::fromNanoseconds(1'500'000'000'123'456'789);
  estimate.status = Status::Tracking;
  NavigationState& state = estimate.state;
  state.world_from_body.rotation = so3::exp(Vec3(0.3, -0.5, 1.2));
  state.world_from_body.translation = Vec3(1.0, -2.0, 3.0);
  state.velocity_W = Vec3(0.4, 0.1, -0.2);
  state.gyroscope_bias_B = Vec3(0.01, -0.02, 0.005);
  // Positive definite, with different entries.
  Eigen::Matrix<double, 15, 15> root = 1e-3 * Eigen::Matrix<double, 15, 15>::Identity();
  for (int i = 0; i < 15; ++i) {
    for (int k = 0; k < i; ++k) root(i, k) = 1e-4 * std::sin(3.0 * i + 7.0 * k);
  }
  estimate.covariance = root * root.transpose();
  return estimate;
}

TEST(Conversions, KeepsTheNanosecondsOfAStamp) {
  const ros::Time time = rosTime(Time::fromNanoseconds(1'500'000'000'123'456'789));
  EXPECT_EQ(time.sec, 1'500'000'000U);
  EXPECT_EQ(time.nsec, 123'456'789U);
  EXPECT_THROW(rosTime(Time::fromNanoseconds(-1)), std::runtime_error);
}

TEST(Conversions, OdometryIsTheBodyInTheWorld) {
  const FrameEstimate estimate = someEstimate();
  const message::Odometry message = odometryMessage(estimate, {}, {"map", "imu"});
  EXPECT_EQ(message.header.frame_id, "map");
  EXPECT_EQ(message.child_frame_id, "imu");
  EXPECT_EQ(message.header.stamp, rosTime(estimate.time));
  EXPECT_EQ(message.pose.pose.position.y, -2.0);
  const Quat q = so3::canonical(estimate.state.world_from_body.rotation);
  EXPECT_EQ(message.pose.pose.orientation.w, q.w());
  EXPECT_EQ(message.pose.pose.orientation.z, q.z());
  const message::TransformStamped transform = transformMessage(estimate, {"map", "imu"});
  EXPECT_EQ(transform.header.frame_id, "map");
  EXPECT_EQ(transform.child_frame_id, "imu");
  EXPECT_EQ(transform.transform.translation.x, 1.0);
  EXPECT_EQ(transform.transform.rotation.x, q.x());
  EXPECT_EQ(poseMessage(estimate, {"map", "imu"}).header.frame_id, "map");
}

TEST(Conversions, NorthIsAMapAboveAWorldThatNeverJumps) {
  FrameEstimate estimate = someEstimate();
  EXPECT_FALSE(northMessage(estimate, {})) << "north is unknown";
  estimate.sensors.of<MagnetometerEstimate>().north_from_world_rad = 2.0;
  const auto north = northMessage(estimate, {"odom", "imu", "north"});
  ASSERT_TRUE(north);
  EXPECT_EQ(north->header.frame_id, "north");
  EXPECT_EQ(north->child_frame_id, "odom");
  EXPECT_EQ(north->transform.translation.x, 0.0);
  EXPECT_NEAR(north->transform.rotation.z, std::sin(1.0), 1e-12);
  EXPECT_NEAR(north->transform.rotation.w, std::cos(1.0), 1e-12);
}

TEST(Conversions, MapAndOdometryGiveThePoseInTheMap) {
  const FrameEstimate estimate = someEstimate();
  const Rigid3 map_from_world(Quat(Eigen::AngleAxisd(-2.5, Vec3::UnitZ())), Vec3(4.0, -3.0, 0.5));
  const auto map = mapMessage(estimate, map_from_world, {});
  const message::TransformStamped body = transformMessage(estimate, {});
  ASSERT_TRUE(map);
  // map -> odom -> base_link is one chain.
  EXPECT_EQ(map->header.frame_id, "map");
  EXPECT_EQ(map->child_frame_id, body.header.frame_id);
  EXPECT_EQ(body.child_frame_id, "base_link");
  EXPECT_EQ(map->header.stamp, body.header.stamp);
  const auto rigid = [](const auto& transform) {
    const auto &q = transform.rotation, &p = transform.translation;
    return Rigid3(Quat(q.w, q.x, q.y, q.z), Vec3(p.x, p.y, p.z));
  };
  const Rigid3 chained = rigid(map->transform) * rigid(body.transform);
  const Rigid3 expected = map_from_world * estimate.state.world_from_body;
  EXPECT_LT((chained.translation - expected.translation).norm(), 1e-12);
  EXPECT_LT(chained.rotation.angularDistance(expected.rotation), 1e-9);
}

TEST(Conversions, WithoutAMapOnlyNorthTurnsTheOdometry) {
  FrameEstimate estimate = someEstimate();
  estimate.sensors.of<MagnetometerEstimate>().north_from_world_rad.reset();
  EXPECT_FALSE(mapMessage(estimate, std::nullopt, {}));
  estimate.sensors.of<MagnetometerEstimate>().north_from_world_rad = 1.0;
  const auto north = mapMessage(estimate, std::nullopt, {});
  ASSERT_TRUE(north);
  EXPECT_NEAR(north->transform.rotation.z, std::sin(0.5), 1e-12);
}

TEST(Conversions, PoseCovarianceIsPositionThenRotationRowByRow) {
  const FrameEstimate estimate = someEstimate();
  const message::Odometry message = odometryMessage(estimate, {}, {});
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      EXPECT_EQ(message.pose.covariance[static_cast<size_t>(6 * row + column)],
                estimate.covariance(row, column));
    }
  }
}

TEST(Conversions, TwistIsInBodyAxesAndFreeFromBias) {
  const FrameEstimate estimate = someEstimate();
  const Turning turning{Vec3(0.1, 0.2, 0.3), 0.0};
  const message::Twist twist = odometryMessage(estimate, turning, {}).twist.twist;
  const Vec3 velocity_W =
      estimate.state.world_from_body.rotation * Vec3(twist.linear.x, twist.linear.y, twist.linear.z);
  EXPECT_LT((velocity_W - estimate.state.velocity_W).norm(), 1e-14);
  EXPECT_NEAR(twist.angular.x, 0.09, 1e-14);
  EXPECT_NEAR(twist.angular.y, 0.22, 1e-14);
  EXPECT_NEAR(twist.angular.z, 0.295, 1e-14);
}

/// [v_B, omega_B] of an estimate with the given error.
Eigen::Matrix<double, 6, 1> twistOf(const FrameEstimate& estimate, const Turning& turning,
                                    const Eigen::Matrix<double, 15, 1>& error) {
  FrameEstimate moved = estimate;
  moved.state.world_from_body = perturbed(estimate.state.world_from_body, error.head<6>());
  moved.state.velocity_W += error.segment<3>(6);
  moved.state.gyroscope_bias_B += error.segment<3>(9);
  const message::Twist twist = odometryMessage(moved, turning, {}).twist.twist;
  Eigen::Matrix<double, 6, 1> vector;
  vector << twist.linear.x, twist.linear.y, twist.linear.z, twist.angular.x, twist.angular.y, twist.angular.z;
  return vector;
}

TEST(Conversions, TwistCovarianceFollowsFromTheStates) {
  const FrameEstimate estimate = someEstimate();
  const Turning turning{Vec3(0.1, 0.2, 0.3), 0.02};
  constexpr double kStep = 1e-6;
  Eigen::Matrix<double, 6, 15> jacobian;
  for (int i = 0; i < 15; ++i) {
    const Eigen::Matrix<double, 15, 1> step = kStep * Eigen::Matrix<double, 15, 1>::Unit(i);
    jacobian.col(i) = (twistOf(estimate, turning, step) - twistOf(estimate, turning, -step)) / (2.0 * kStep);
  }
  Eigen::Matrix<double, 6, 6> expected = jacobian * estimate.covariance * jacobian.transpose();
  expected.diagonal().tail<3>().array() += 0.02 * 0.02;
  const message::Odometry message = odometryMessage(estimate, turning, {});
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      EXPECT_NEAR(message.twist.covariance[static_cast<size_t>(6 * row + column)], expected(row, column),
                  1e-12)
          << row << ' ' << column;
    }
  }
}

template <typename Number>
Number numberAt(const decltype(message::PointCloud2::data)& bytes, size_t offset) {
  Number number;
  std::memcpy(&number, bytes.data() + offset, sizeof(Number));
  return number;
}

TEST(Conversions, CloudLaysPointsOutAsItsFieldsSay) {
  const std::vector<MapPoint> points = {{1, Vec3(1.0, 2.0, 3.0), 4}, {2, Vec3(-5.5, 6.0, 7.0), 8}};
  const message::PointCloud2 cloud = landmarkCloud(points, Time::fromNanoseconds(1), {});
  EXPECT_EQ(cloud.header.frame_id, "odom");
  EXPECT_EQ(cloud.width * cloud.height, 2U);
  ASSERT_EQ(cloud.data.size(), cloud.row_step * cloud.height);
  ASSERT_EQ(cloud.fields.size(), 4U);
  for (size_t i = 0; i < points.size(); ++i) {
    const size_t start = i * cloud.point_step;
    for (int axis = 0; axis < 3; ++axis) {
      const message::PointField& field = cloud.fields[static_cast<size_t>(axis)];
      EXPECT_EQ(field.name, std::string(1, "xyz"[axis]));
      EXPECT_EQ(field.datatype, message::PointField::FLOAT32);
      EXPECT_EQ(numberAt<float>(cloud.data, start + field.offset),
                static_cast<float>(points[i].position_W[axis]));
    }
    EXPECT_EQ(cloud.fields[3].name, "observations");
    EXPECT_EQ(cloud.fields[3].datatype, message::PointField::UINT32);
    EXPECT_EQ(numberAt<uint32_t>(cloud.data, start + cloud.fields[3].offset),
              static_cast<uint32_t>(points[i].observations));
  }
  EXPECT_TRUE(landmarkCloud({}, Time::fromNanoseconds(1), {}).data.empty());
}

}  // namespace
}  // namespace lodeline

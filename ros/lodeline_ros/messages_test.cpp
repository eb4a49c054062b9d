#include <gtest/gtest.h>
#include <ros/serialization.h>

#include "lodeline/factors/parameters.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/node/messages/diagnostic_message.h"
#include "lodeline/node/messages/estimate_messages.h"
#include "lodeline_ros/message_types.h"

// What ROS 1's own types read in the messages of estimates.

namespace lodeline {
namespace {

/// Reads a message of ROS 1; it must end where its bytes do.
template <typename Message>
Message decoded(wire::Bytes bytes) {
  Message message;
  ros::serialization::IStream stream(bytes.data(), static_cast<uint32_t>(bytes.size()));
  ros::serialization::deserialize(stream, message);
  EXPECT_EQ(stream.getLength(), 0U);
  return message;
}

message::Odometry odometryOf(const FrameEstimate& estimate, const Turning& turning, const FrameNames& names) {
  return decoded<message::Odometry>(odometryMessage(estimate, turning, names, Serialization::Ros1));
}

message::TFMessage transformsOf(const FrameEstimate& estimate, const FrameNames& names,
                                const std::optional<Rigid3>& map_from_world) {
  std::vector<FrameTransform> transforms = {bodyTransform(estimate, names)};
  if (const auto map = mapTransform(estimate, map_from_world, names)) transforms.push_back(*map);
  return decoded<message::TFMessage>(transformsMessage(estimate.time, transforms, Serialization::Ros1));
}

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

TEST(Ros1Messages, KeepTheNanosecondsOfAStamp) {
  const message::Odometry message = odometryOf(someEstimate(), {}, {});
  EXPECT_EQ(message.header.stamp.sec, 1'500'000'000U);
  EXPECT_EQ(message.header.stamp.nsec, 123'456'789U);
  FrameEstimate early;
  early.time = Time::fromNanoseconds(-1);
  EXPECT_THROW(odometryMessage(early, {}, {}, Serialization::Ros1), std::runtime_error);
}

TEST(Ros1Messages, OdometryIsTheBodyInTheWorld) {
  const FrameEstimate estimate = someEstimate();
  const FrameNames names = {"map", "imu"};
  const message::Odometry message = odometryOf(estimate, {}, names);
  EXPECT_EQ(message.header.frame_id, "map");
  EXPECT_EQ(message.child_frame_id, "imu");
  EXPECT_EQ(message.pose.pose.position.y, -2.0);
  const Quat q = so3::canonical(estimate.state.world_from_body.rotation);
  EXPECT_EQ(message.pose.pose.orientation.w, q.w());
  EXPECT_EQ(message.pose.pose.orientation.z, q.z());
  const message::TransformStamped transform = transformsOf(estimate, names, {}).transforms.at(0);
  EXPECT_EQ(transform.header.frame_id, "map");
  EXPECT_EQ(transform.child_frame_id, "imu");
  EXPECT_EQ(transform.transform.translation.x, 1.0);
  EXPECT_EQ(transform.transform.rotation.x, q.x());
}

TEST(Ros1Messages, PosesEqualTheOdometry) {
  const FrameEstimate estimate = someEstimate();
  const message::Odometry odometry = odometryOf(estimate, {}, {});
  const auto pose = decoded<message::PoseStamped>(poseMessage(estimate, {}, Serialization::Ros1));
  EXPECT_EQ(pose.header.frame_id, "odom");
  EXPECT_EQ(pose.pose, odometry.pose.pose);
  const auto with_covariance = decoded<message::PoseWithCovarianceStamped>(
      poseWithCovarianceMessage(estimate, {}, Serialization::Ros1));
  EXPECT_EQ(with_covariance.header, odometry.header);
  EXPECT_EQ(with_covariance.pose, odometry.pose);
  const std::vector<StampedPose> poses(3, {estimate.time, estimate.state.world_from_body});
  const auto path = decoded<message::Path>(pathMessage(poses, {}, Serialization::Ros1));
  ASSERT_EQ(path.poses.size(), 3U);
  EXPECT_EQ(path.header.stamp, pose.header.stamp);
  EXPECT_EQ(path.poses.back().pose, pose.pose);
}

TEST(Ros1Messages, NorthIsAMapAboveAWorldThatNeverJumps) {
  FrameEstimate estimate = someEstimate();
  EXPECT_EQ(transformsOf(estimate, {}, {}).transforms.size(), 1U) << "north is unknown";
  estimate.sensors.of<MagnetometerEstimate>().north_from_world_rad = 2.0;
  const message::TFMessage message = transformsOf(estimate, {"odom", "imu", "north"}, {});
  ASSERT_EQ(message.transforms.size(), 2U);
  const message::TransformStamped& north = message.transforms[1];
  EXPECT_EQ(north.header.frame_id, "north");
  EXPECT_EQ(north.child_frame_id, "odom");
  EXPECT_EQ(north.transform.translation.x, 0.0);
  EXPECT_NEAR(north.transform.rotation.z, std::sin(1.0), 1e-12);
  EXPECT_NEAR(north.transform.rotation.w, std::cos(1.0), 1e-12);
}

TEST(Ros1Messages, MapAndOdometryGiveThePoseInTheMap) {
  const FrameEstimate estimate = someEstimate();
  const Rigid3 map_from_world(Quat(Eigen::AngleAxisd(-2.5, Vec3::UnitZ())), Vec3(4.0, -3.0, 0.5));
  const message::TFMessage message = transformsOf(estimate, {}, map_from_world);
  ASSERT_EQ(message.transforms.size(), 2U);
  const message::TransformStamped &body = message.transforms[0], &map = message.transforms[1];
  // map -> odom -> base_link is one chain.
  EXPECT_EQ(map.header.frame_id, "map");
  EXPECT_EQ(map.child_frame_id, body.header.frame_id);
  EXPECT_EQ(body.child_frame_id, "base_link");
  EXPECT_EQ(map.header.stamp, body.header.stamp);
  const auto rigid = [](const auto& transform) {
    const auto& q = transform.rotation;
    const auto& p = transform.translation;
    return Rigid3(Quat(q.w, q.x, q.y, q.z), Vec3(p.x, p.y, p.z));
  };
  const Rigid3 chained = rigid(map.transform) * rigid(body.transform);
  const Rigid3 expected = map_from_world * estimate.state.world_from_body;
  EXPECT_LT((chained.translation - expected.translation).norm(), 1e-12);
  EXPECT_LT(chained.rotation.angularDistance(expected.rotation), 1e-9);
}

TEST(Ros1Messages, PoseCovarianceIsPositionThenRotationRowByRow) {
  const FrameEstimate estimate = someEstimate();
  const message::Odometry message = odometryOf(estimate, {}, {});
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      EXPECT_EQ(message.pose.covariance[static_cast<size_t>(6 * row + column)],
                estimate.covariance(row, column));
    }
  }
}

TEST(Ros1Messages, TwistIsInBodyAxesAndFreeFromBias) {
  const FrameEstimate estimate = someEstimate();
  const Turning turning{Vec3(0.1, 0.2, 0.3), 0.0};
  const message::Twist twist = odometryOf(estimate, turning, {}).twist.twist;
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
  const message::Twist twist = odometryOf(moved, turning, {}).twist.twist;
  Eigen::Matrix<double, 6, 1> vector;
  vector << twist.linear.x, twist.linear.y, twist.linear.z, twist.angular.x, twist.angular.y, twist.angular.z;
  return vector;
}

TEST(Ros1Messages, TwistCovarianceFollowsFromTheStates) {
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
  const message::Odometry message = odometryOf(estimate, turning, {});
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

TEST(Ros1Messages, CloudLaysPointsOutAsItsFieldsSay) {
  const std::vector<MapPoint> points = {{1, Vec3(1.0, 2.0, 3.0), 4}, {2, Vec3(-5.5, 6.0, 7.0), 8}};
  const auto cloud =
      decoded<message::PointCloud2>(landmarkCloud(points, Time::fromNanoseconds(1), {}, Serialization::Ros1));
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
  const auto none =
      decoded<message::PointCloud2>(landmarkCloud({}, Time::fromNanoseconds(1), {}, Serialization::Ros1));
  EXPECT_TRUE(none.data.empty());
}

TEST(Ros1Messages, DiagnosticsKeepTheirValues) {
  DiagnosticStatus status;
  status.level = DiagnosticStatus::kWarn;
  status.name = "lodeline: estimator";
  status.message = "waiting";
  status.add("frames", "12");
  status.add("depth", "");
  const auto array = decoded<message::DiagnosticArray>(
      diagnosticsMessage(Time::fromNanoseconds(5), {status, {}}, Serialization::Ros1));
  ASSERT_EQ(array.status.size(), 2U);
  EXPECT_EQ(array.status[0].level, message::DiagnosticStatus::WARN);
  EXPECT_EQ(array.status[0].name, "lodeline: estimator");
  EXPECT_EQ(array.status[0].message, "waiting");
  ASSERT_EQ(array.status[0].values.size(), 2U);
  EXPECT_EQ(array.status[0].values[0].key, "frames");
  EXPECT_EQ(array.status[0].values[0].value, "12");
}

}  // namespace
}  // namespace lodeline

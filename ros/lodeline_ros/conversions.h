#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/estimator/estimator.h"
#include "lodeline_ros/message_types.h"

/// What the estimator knows, in the messages of ROS 1 (packages geometry_msgs, nav_msgs, sensor_msgs 1.13).
namespace lodeline {

/// Names of the frames in messages: the map (east, north, up), the world (of the first pose; never jumps) and
/// the body (the IMU). The map is the world where north is known at the start.
struct FrameNames {
  std::string world = "world";
  std::string body = "body";
  std::string map = "map";
};

/// How the body turns at the time of an estimate, by the gyroscope.
struct Turning {
  Vec3 reading_B = Vec3::Zero();  ///< rad/s, biased
  double sigma_rad_per_s = 0.0;   ///< white noise of one reading, per axis
};

/// ROS counts whole seconds since its epoch in 32 bits without sign; throws std::runtime_error beyond them.
ros::Time rosTime(Time time);

/// Pose of the body in the world with covariance of [x y z, rotation about the world's x y z], m and rad; the
/// velocities in body axes, as the message asks for, with covariance of [v, omega]. The angular velocity is
/// the reading freed from the estimated bias. Covariances are relative to the first pose's position and
/// heading, as in FrameEstimate.
message::Odometry odometryMessage(const FrameEstimate& estimate, const Turning& turning,
                                  const FrameNames& names);

message::PoseStamped poseMessage(const FrameEstimate& estimate, const FrameNames& names);
message::TransformStamped transformMessage(const FrameEstimate& estimate, const FrameNames& names);
/// The world in the map: a turn about the vertical to north, as known now. Nothing while north is unknown.
std::optional<message::TransformStamped> northMessage(const FrameEstimate& estimate, const FrameNames& names);

/// Points in the world, m, as x, y, z (FLOAT32) and `observations` (UINT32), 16 bytes a point.
message::PointCloud2 landmarkCloud(const std::vector<MapPoint>& points, Time time, const FrameNames& names);

}  // namespace lodeline

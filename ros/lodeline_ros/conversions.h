#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/estimate.h"
#include "lodeline_ros/message_types.h"

/// Functions that convert estimates to ROS 1 messages (packages geometry_msgs, nav_msgs, sensor_msgs 1.13).
namespace lodeline {

/// Names of the frames in messages, as in REP-105: the map (east, north, up; jumps where a loop is closed),
/// the odometry's world (of the first pose; never jumps) and the body (the IMU).
struct FrameNames {
  std::string world = "odom";
  std::string body = "base_link";
  std::string map = "map";
};

/// Angular velocity of the body at the time of an estimate, from the gyroscope.
struct Turning {
  Vec3 reading_B = Vec3::Zero();  ///< rad/s, biased
  double sigma_rad_per_s = 0.0;   ///< white noise of one reading, one sigma per axis
};

/// Converts a time to ROS's unsigned 32-bit seconds and nanoseconds. Throws std::runtime_error outside their
/// range.
ros::Time rosTime(Time time);

/// Pose of the body in the world with the covariance of [x y z, rotation about the world's x y z], m and rad.
/// The velocities are in body axes, as the message requires, with the covariance of [v, omega]. The angular
/// velocity is the reading minus the estimated bias. Covariances are relative to the position and heading of
/// the first pose, as in FrameEstimate.
message::Odometry odometryMessage(const FrameEstimate& estimate, const Turning& turning,
                                  const FrameNames& names);

message::PoseStamped poseMessage(const FrameEstimate& estimate, const FrameNames& names);
message::TransformStamped transformMessage(const FrameEstimate& estimate, const FrameNames& names);
/// Transformation of the world in the map: a rotation about the vertical to the current estimate of north.
/// Returns nothing while north is unknown.
std::optional<message::TransformStamped> northMessage(const FrameEstimate& estimate, const FrameNames& names);

/// Transformation of the world in the map. `map_from_world`: by the map of the run, empty where it has none;
/// then northMessage().
std::optional<message::TransformStamped> mapMessage(const FrameEstimate& estimate,
                                                    const std::optional<Rigid3>& map_from_world,
                                                    const FrameNames& names);

/// Landmarks in the world, m, as x, y, z (FLOAT32) and `observations` (UINT32), 16 bytes per point.
message::PointCloud2 landmarkCloud(const std::vector<MapPoint>& points, Time time, const FrameNames& names);

}  // namespace lodeline

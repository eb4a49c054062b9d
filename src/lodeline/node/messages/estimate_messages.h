#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/estimate.h"
#include "lodeline/node/messages/message_writer.h"
#include "lodeline/trajectory.h"

/// Functions that make messages of estimates, in either serialization of ROS.
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

/// A rigid motion between two frames.
struct FrameTransform {
  std::string parent, child;
  Rigid3 parent_from_child;
};

using Serialization = definitions::Serialization;

/// nav_msgs/Odometry: pose of the body in the world with the covariance of [x y z, rotation about the world's
/// x y z], m and rad. The velocities are in body axes, as the message requires, with the covariance of [v,
/// omega]. The angular velocity is the reading minus the estimated bias. Covariances are relative to the
/// position and heading of the first pose, as in FrameEstimate.
wire::Bytes odometryMessage(const FrameEstimate& estimate, const Turning& turning, const FrameNames& names,
                            Serialization serialization);
/// geometry_msgs/PoseStamped
wire::Bytes poseMessage(const FrameEstimate& estimate, const FrameNames& names, Serialization serialization);
/// geometry_msgs/PoseWithCovarianceStamped, with the covariance of the odometry message.
wire::Bytes poseWithCovarianceMessage(const FrameEstimate& estimate, const FrameNames& names,
                                      Serialization serialization);
/// nav_msgs/Path of poses in the world.
wire::Bytes pathMessage(const std::vector<StampedPose>& poses, const FrameNames& names,
                        Serialization serialization);
/// tf2_msgs/TFMessage
wire::Bytes transformsMessage(Time time, const std::vector<FrameTransform>& transforms,
                              Serialization serialization);
/// sensor_msgs/PointCloud2 of landmarks in the world, m, as x, y, z (FLOAT32) and `observations` (UINT32), 16
/// bytes per point.
wire::Bytes landmarkCloud(const std::vector<MapPoint>& points, Time time, const FrameNames& names,
                          Serialization serialization);

/// The body in the world.
FrameTransform bodyTransform(const FrameEstimate& estimate, const FrameNames& names);
/// The world in the map. `map_from_world`: by the map of the run, empty where it has none; then a rotation
/// about the vertical to the current estimate of north. Returns nothing while north is unknown.
std::optional<FrameTransform> mapTransform(const FrameEstimate& estimate,
                                           const std::optional<Rigid3>& map_from_world,
                                           const FrameNames& names);

}  // namespace lodeline

#pragma once

#include <ros/node_handle.h>

#include <optional>

#include "lodeline/estimator/packet_odometry.h"
#include "lodeline/io/synchronizer/frame_packet.h"
#include "lodeline_ros/conversions.h"

namespace lodeline {

/// Publishes the result of each frame: ~odometry and, optionally, /tf for every frame; ~landmarks of the
/// window at keyframes; ~path of the keyframes once per second of the sensors' time.
class EstimatePublisher {
 public:
  /// `node`: handle of the private namespace.
  EstimatePublisher(ros::NodeHandle node, FrameNames names, bool with_tf);

  /// Publishes nothing for a frame without a pose. `imu`: calibration of the IMU of the packet's readings.
  /// `map_from_world`: by the map of the run, see RunMapping; empty where there is none.
  void publish(const FramePacket& packet, const FrameEstimate& estimate, const PacketOdometry& odometry,
               const ImuCalibration& imu, const std::optional<Rigid3>& map_from_world);

 private:
  void publishPath(const FrameEstimate& estimate);

  FrameNames names_;
  ros::Publisher odometry_, path_, landmarks_, tf_;
  message::Path keyframes_;
  std::optional<Time> path_time_;  ///< time of the path published last
};

}  // namespace lodeline

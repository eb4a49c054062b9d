#pragma once

#include <ros/node_handle.h>

#include <optional>

#include "lodeline/estimator/odometry.h"
#include "lodeline/io/synchronizer/frame_packet.h"
#include "lodeline_ros/conversions.h"

namespace lodeline {

/// Publishes what became of each frame: ~odometry and, where wanted, /tf at once; at keyframes ~landmarks
/// (those of the window); ~path of the keyframes once a second of the sensors' time.
class EstimatePublisher {
 public:
  /// `node`: of the private name space.
  EstimatePublisher(ros::NodeHandle node, FrameNames names, bool with_tf);

  /// Nothing for a frame without a pose. `imu` made the packet's readings.
  void publish(const FramePacket& packet, const FrameEstimate& estimate, const Odometry& odometry,
               const ImuCalibration& imu);

 private:
  void publishPath(const FrameEstimate& estimate);

  FrameNames names_;
  ros::Publisher odometry_, path_, landmarks_, tf_;
  message::Path keyframes_;
  std::optional<Time> path_time_;  ///< of the path published last
};

}  // namespace lodeline

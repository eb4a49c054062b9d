#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/estimator/packet_odometry.h"
#include "lodeline/io/synchronizer/frame_packet.h"
#include "lodeline/node/messages/estimate_messages.h"

namespace lodeline {

/// A topic on which results are published.
struct Publication {
  std::string topic;  ///< in the node's namespace, or absolute with a slash in front
  std::string type;   ///< e.g. "nav_msgs/Odometry"
  int depth = 0;      ///< most messages that wait
  /// Whether subscribers that come later get the last message (latched in ROS 1, transient local in ROS 2).
  bool is_latched = false;
};

/// Topics in the order of the numbers with which they are published.
enum class Output : size_t { Odometry, Pose, PoseWithCovariance, Path, Landmarks, Diagnostics, Transforms };
std::vector<Publication> publications(bool with_transforms);

/// Publishes the result of each frame: odometry, poses and, optionally, transforms for every frame; landmarks
/// of the window at keyframes; the path of the keyframes once per second of the sensors' time.
class EstimatePublisher {
 public:
  using Publish = std::function<void(Output output, wire::Bytes message)>;

  EstimatePublisher(FrameNames names, bool with_transforms, Serialization serialization, Publish publish);

  /// Publishes nothing for a frame without a pose. `imu`: calibration of the IMU of the packet's readings.
  /// `map_from_world`: by the map of the run, see RunMapping; empty where there is none.
  void publish(const FramePacket& packet, const FrameEstimate& estimate, const PacketOdometry& odometry,
               const ImuCalibration& imu, const std::optional<Rigid3>& map_from_world);

 private:
  void publishPath(const FrameEstimate& estimate);

  FrameNames names_;
  bool with_transforms_;
  Serialization serialization_;
  Publish publish_;
  std::vector<StampedPose> keyframes_;
  std::optional<Time> path_time_;  ///< time of the path published last
};

}  // namespace lodeline

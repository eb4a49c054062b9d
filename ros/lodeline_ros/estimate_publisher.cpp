#include "lodeline_ros/estimate_publisher.h"

#include <cmath>

namespace lodeline {
namespace {

constexpr uint32_t kQueue = 1000;
constexpr double kPathPause_s = 1.0;

}  // namespace

EstimatePublisher::EstimatePublisher(ros::NodeHandle node, FrameNames names, bool with_tf)
    : names_(std::move(names)) {
  odometry_ = node.advertise<message::Odometry>("odometry", kQueue);
  path_ = node.advertise<message::Path>("path", 1, true);
  landmarks_ = node.advertise<message::PointCloud2>("landmarks", 10);
  if (with_tf) tf_ = node.advertise<message::TFMessage>("/tf", kQueue);
  keyframes_.header.frame_id = names_.world;
}

void EstimatePublisher::publish(const FramePacket& packet, const FrameEstimate& estimate,
                                const PacketOdometry& odometry, const ImuCalibration& imu,
                                const std::optional<Rigid3>& map_from_world) {
  if (estimate.status == Status::Waiting) return;
  const double gyroscope_sigma = imu.noise.gyroscope_density_rad_per_s_sqrtHz * std::sqrt(imu.rate_hz);
  const Turning turning{packet.imu.back().angular_velocity_B, gyroscope_sigma};
  odometry_.publish(odometryMessage(estimate, turning, names_));
  if (tf_) {
    message::TFMessage transforms;
    transforms.transforms.push_back(transformMessage(estimate, names_));
    if (auto map = mapMessage(estimate, map_from_world, names_))
      transforms.transforms.push_back(std::move(*map));
    tf_.publish(transforms);
  }
  if (!estimate.is_keyframe) return;
  publishPath(estimate);
  if (landmarks_.getNumSubscribers() > 0) {
    landmarks_.publish(landmarkCloud(odometry.estimator().currentMapPoints(), estimate.time, names_));
  }
}

void EstimatePublisher::publishPath(const FrameEstimate& estimate) {
  keyframes_.poses.push_back(poseMessage(estimate, names_));
  if (path_time_ && (estimate.time - *path_time_).seconds() < kPathPause_s) return;
  path_time_ = estimate.time;
  keyframes_.header.stamp = rosTime(estimate.time);
  path_.publish(keyframes_);
}

}  // namespace lodeline

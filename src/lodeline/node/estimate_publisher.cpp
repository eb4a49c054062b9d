#include "lodeline/node/estimate_publisher.h"

#include <cmath>

namespace lodeline {
namespace {

constexpr int kQueue = 1000;
constexpr double kPathPause_s = 1.0;

}  // namespace

std::vector<Publication> publications(bool with_transforms) {
  std::vector<Publication> topics = {
      {"odometry", "nav_msgs/Odometry", kQueue, false},
      {"pose", "geometry_msgs/PoseStamped", kQueue, false},
      {"pose_with_covariance", "geometry_msgs/PoseWithCovarianceStamped", kQueue, false},
      {"path", "nav_msgs/Path", 1, true},
      {"landmarks", "sensor_msgs/PointCloud2", 10, false},
      {"/diagnostics", "diagnostic_msgs/DiagnosticArray", 10, false},
  };
  if (with_transforms) topics.push_back({"/tf", "tf2_msgs/TFMessage", kQueue, false});
  return topics;
}

EstimatePublisher::EstimatePublisher(FrameNames names, bool with_transforms, Serialization serialization,
                                     Publish publish)
    : names_(std::move(names)),
      with_transforms_(with_transforms),
      serialization_(serialization),
      publish_(std::move(publish)) {}

void EstimatePublisher::publish(const FramePacket& packet, const FrameEstimate& estimate,
                                const PacketOdometry& odometry, const ImuCalibration& imu,
                                const std::optional<Rigid3>& map_from_world) {
  if (estimate.status == Status::Waiting) return;
  const double gyroscope_sigma = imu.noise.gyroscope_density_rad_per_s_sqrtHz * std::sqrt(imu.rate_hz);
  // Without a reading, the angular velocity is unknown and stated as none.
  const Vec3 reading_B =
      packet.imu.empty() ? estimate.state.gyroscope_bias_B : packet.imu.back().angular_velocity_B;
  const Turning turning{reading_B, gyroscope_sigma};
  publish_(Output::Odometry, odometryMessage(estimate, turning, names_, serialization_));
  publish_(Output::Pose, poseMessage(estimate, names_, serialization_));
  publish_(Output::PoseWithCovariance, poseWithCovarianceMessage(estimate, names_, serialization_));
  if (with_transforms_) {
    std::vector<FrameTransform> transforms = {bodyTransform(estimate, names_)};
    if (auto map = mapTransform(estimate, map_from_world, names_)) transforms.push_back(std::move(*map));
    publish_(Output::Transforms, transformsMessage(estimate.time, transforms, serialization_));
  }
  if (!estimate.is_keyframe) return;
  publishPath(estimate);
  publish_(Output::Landmarks,
           landmarkCloud(odometry.estimator().currentMapPoints(), estimate.time, names_, serialization_));
}

void EstimatePublisher::publishPath(const FrameEstimate& estimate) {
  keyframes_.push_back({estimate.time, estimate.state.world_from_body});
  if (path_time_ && (estimate.time - *path_time_).seconds() < kPathPause_s) return;
  path_time_ = estimate.time;
  publish_(Output::Path, pathMessage(keyframes_, names_, serialization_));
}

}  // namespace lodeline

#include "lodeline_ros/conversions.h"

#include <cstring>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

// First indices of the parts of the estimate's covariance (see parameters.h).
constexpr int kRotation = 3;
constexpr int kVelocity = 6;
constexpr int kGyroscopeBias = 9;

using Covariance6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

template <typename Vector>
Vector vectorMessage(const Vec3& vector) {
  Vector message;
  message.x = vector.x();
  message.y = vector.y();
  message.z = vector.z();
  return message;
}

message::Quaternion quaternionMessage(const Quat& any_sign) {
  const Quat rotation = so3::canonical(any_sign);
  message::Quaternion message;
  message.x = rotation.x();
  message.y = rotation.y();
  message.z = rotation.z();
  message.w = rotation.w();
  return message;
}

message::Pose poseOf(const FrameEstimate& estimate) {
  message::Pose pose;
  pose.position = vectorMessage<message::Point>(estimate.state.world_from_body.translation);
  pose.orientation = quaternionMessage(estimate.state.world_from_body.rotation);
  return pose;
}

void store(const Covariance6& covariance, boost::array<double, 36>* message) {
  std::memcpy(message->data(), covariance.data(), sizeof(double) * 36);
}

/// Covariance of [v_B, omega_B]. A rotation error dtheta in world axes rotates the true velocity by R_B_W
/// (v_W x dtheta) relative to the estimated one.
Covariance6 twistCovariance(const FrameEstimate& estimate, double gyroscope_sigma) {
  const Mat3 body_from_world = estimate.state.world_from_body.rotation.toRotationMatrix().transpose();
  Eigen::Matrix<double, 6, 15> twist_from_error = Eigen::Matrix<double, 6, 15>::Zero();
  twist_from_error.block<3, 3>(0, kRotation) = body_from_world * so3::skew(estimate.state.velocity_W);
  twist_from_error.block<3, 3>(0, kVelocity) = body_from_world;
  twist_from_error.block<3, 3>(3, kGyroscopeBias) = -Mat3::Identity();
  Covariance6 covariance = twist_from_error * estimate.covariance * twist_from_error.transpose();
  covariance.diagonal().tail<3>().array() += gyroscope_sigma * gyroscope_sigma;
  return covariance;
}

template <typename Message>
Message headed(Time time, const std::string& frame) {
  Message message;
  message.header.stamp = rosTime(time);
  message.header.frame_id = frame;
  return message;
}

message::PointField field(const char* name, uint32_t offset, uint8_t type) {
  message::PointField field;
  field.name = name;
  field.offset = offset;
  field.datatype = type;
  field.count = 1;
  return field;
}

}  // namespace

ros::Time rosTime(Time time) {
  ros::Time ros_time;
  if (time.nanoseconds() < 0) throw std::runtime_error("a time before ROS's epoch");
  ros_time.fromNSec(static_cast<uint64_t>(time.nanoseconds()));
  return ros_time;
}

message::Odometry odometryMessage(const FrameEstimate& estimate, const Turning& turning,
                                  const FrameNames& names) {
  auto message = headed<message::Odometry>(estimate.time, names.world);
  message.child_frame_id = names.body;
  message.pose.pose = poseOf(estimate);
  store(estimate.covariance.topLeftCorner<6, 6>(), &message.pose.covariance);
  const NavigationState& state = estimate.state;
  message.twist.twist.linear =
      vectorMessage<message::Vector3>(state.world_from_body.rotation.conjugate() * state.velocity_W);
  message.twist.twist.angular = vectorMessage<message::Vector3>(turning.reading_B - state.gyroscope_bias_B);
  store(twistCovariance(estimate, turning.sigma_rad_per_s), &message.twist.covariance);
  return message;
}

message::PoseStamped poseMessage(const FrameEstimate& estimate, const FrameNames& names) {
  auto message = headed<message::PoseStamped>(estimate.time, names.world);
  message.pose = poseOf(estimate);
  return message;
}

message::TransformStamped transformMessage(const FrameEstimate& estimate, const FrameNames& names) {
  auto message = headed<message::TransformStamped>(estimate.time, names.world);
  message.child_frame_id = names.body;
  const Rigid3& world_from_body = estimate.state.world_from_body;
  message.transform.translation = vectorMessage<message::Vector3>(world_from_body.translation);
  message.transform.rotation = quaternionMessage(world_from_body.rotation);
  return message;
}

std::optional<message::TransformStamped> northMessage(const FrameEstimate& estimate,
                                                      const FrameNames& names) {
  const std::optional<double>& turn_rad = estimate.sensors.of<MagnetometerEstimate>().north_from_world_rad;
  if (!turn_rad) return std::nullopt;
  auto message = headed<message::TransformStamped>(estimate.time, names.map);
  message.child_frame_id = names.world;
  message.transform.rotation = quaternionMessage(so3::exp(*turn_rad * Vec3::UnitZ()));
  return message;
}

std::optional<message::TransformStamped> mapMessage(const FrameEstimate& estimate,
                                                    const std::optional<Rigid3>& map_from_world,
                                                    const FrameNames& names) {
  if (!map_from_world) return northMessage(estimate, names);
  auto message = headed<message::TransformStamped>(estimate.time, names.map);
  message.child_frame_id = names.world;
  message.transform.translation = vectorMessage<message::Vector3>(map_from_world->translation);
  message.transform.rotation = quaternionMessage(map_from_world->rotation);
  return message;
}

message::PointCloud2 landmarkCloud(const std::vector<MapPoint>& points, Time time, const FrameNames& names) {
  auto cloud = headed<message::PointCloud2>(time, names.world);
  using message::PointField;
  cloud.fields = {field("x", 0, PointField::FLOAT32), field("y", 4, PointField::FLOAT32),
                  field("z", 8, PointField::FLOAT32), field("observations", 12, PointField::UINT32)};
  cloud.height = 1;
  cloud.width = static_cast<uint32_t>(points.size());
  cloud.is_bigendian = false;
  cloud.is_dense = true;
  cloud.point_step = 16;
  cloud.row_step = cloud.point_step * cloud.width;
  cloud.data.resize(cloud.row_step);
  uint8_t* place = cloud.data.data();
  for (const MapPoint& point : points) {
    const Eigen::Vector3f position = point.position_W.cast<float>();
    const auto observations = static_cast<uint32_t>(point.observations);
    std::memcpy(place, position.data(), 12);
    std::memcpy(place + 12, &observations, 4);
    place += cloud.point_step;
  }
  return cloud;
}

}  // namespace lodeline

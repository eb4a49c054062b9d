#include "lodeline/node/messages/estimate_messages.h"

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

// First indices of the parts of the estimate's covariance (see parameters.h).
constexpr int kRotation = 3;
constexpr int kVelocity = 6;
constexpr int kGyroscopeBias = 9;

using Covariance6 = Eigen::Matrix<double, 6, 6>;

// Numbers of types in sensor_msgs/PointField.
constexpr uint8_t kUInt32 = 6, kFloat32 = 7;
constexpr uint32_t kPointBytes = 16;

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

Covariance6 poseCovariance(const FrameEstimate& estimate) {
  return estimate.covariance.topLeftCorner<6, 6>();
}

void putField(const char* name, uint32_t offset, uint8_t type, MessageWriter* writer) {
  writer->text(name);
  writer->put(offset);
  writer->put(type);
  writer->put(uint32_t{1});  // elements
}

}  // namespace

wire::Bytes odometryMessage(const FrameEstimate& estimate, const Turning& turning, const FrameNames& names,
                            Serialization serialization) {
  const NavigationState& state = estimate.state;
  MessageWriter writer(serialization);
  writer.header(estimate.time, names.world);
  writer.text(names.body);
  writer.put(state.world_from_body);
  writer.put(poseCovariance(estimate));
  writer.put(Vec3(state.world_from_body.rotation.conjugate() * state.velocity_W));
  writer.put(Vec3(turning.reading_B - state.gyroscope_bias_B));
  writer.put(twistCovariance(estimate, turning.sigma_rad_per_s));
  return writer.take();
}

wire::Bytes poseMessage(const FrameEstimate& estimate, const FrameNames& names, Serialization serialization) {
  MessageWriter writer(serialization);
  writer.header(estimate.time, names.world);
  writer.put(estimate.state.world_from_body);
  return writer.take();
}

wire::Bytes poseWithCovarianceMessage(const FrameEstimate& estimate, const FrameNames& names,
                                      Serialization serialization) {
  MessageWriter writer(serialization);
  writer.header(estimate.time, names.world);
  writer.put(estimate.state.world_from_body);
  writer.put(poseCovariance(estimate));
  return writer.take();
}

wire::Bytes pathMessage(const std::vector<StampedPose>& poses, const FrameNames& names,
                        Serialization serialization) {
  constexpr size_t kPoseBytes = 96;
  MessageWriter writer(serialization, kPoseBytes * (poses.size() + 1));
  writer.header(poses.empty() ? Time() : poses.back().time, names.world);
  writer.count(poses.size());
  for (const StampedPose& pose : poses) {
    writer.header(pose.time, names.world);
    writer.put(pose.world_from_body);
  }
  return writer.take();
}

wire::Bytes transformsMessage(Time time, const std::vector<FrameTransform>& transforms,
                              Serialization serialization) {
  MessageWriter writer(serialization);
  writer.count(transforms.size());
  for (const FrameTransform& transform : transforms) {
    writer.header(time, transform.parent);
    writer.text(transform.child);
    writer.put(transform.parent_from_child);
  }
  return writer.take();
}

wire::Bytes landmarkCloud(const std::vector<MapPoint>& points, Time time, const FrameNames& names,
                          Serialization serialization) {
  const auto data_bytes = static_cast<uint32_t>(kPointBytes * points.size());
  MessageWriter writer(serialization, data_bytes + 256);
  writer.header(time, names.world);
  writer.put(uint32_t{1});  // height
  writer.put(static_cast<uint32_t>(points.size()));
  writer.count(4);
  putField("x", 0, kFloat32, &writer);
  putField("y", 4, kFloat32, &writer);
  putField("z", 8, kFloat32, &writer);
  putField("observations", 12, kUInt32, &writer);
  writer.put(false);  // little endian
  writer.put(kPointBytes);
  writer.put(data_bytes);  // of a row
  writer.count(data_bytes);
  for (const MapPoint& point : points) {
    // Multiples of 4 bytes from the first on, which CDR aligns as well.
    for (const double value : point.position_W) writer.put(static_cast<float>(value));
    writer.put(static_cast<uint32_t>(point.observations));
  }
  writer.put(true);  // no invalid points
  return writer.take();
}

FrameTransform bodyTransform(const FrameEstimate& estimate, const FrameNames& names) {
  return {names.world, names.body, estimate.state.world_from_body};
}

std::optional<FrameTransform> mapTransform(const FrameEstimate& estimate,
                                           const std::optional<Rigid3>& map_from_world,
                                           const FrameNames& names) {
  if (map_from_world) return FrameTransform{names.map, names.world, *map_from_world};
  const std::optional<double>& turn_rad = estimate.sensors.of<MagnetometerEstimate>().north_from_world_rad;
  if (!turn_rad) return std::nullopt;
  return FrameTransform{names.map, names.world, Rigid3(so3::exp(*turn_rad * Vec3::UnitZ()), Vec3::Zero())};
}

}  // namespace lodeline

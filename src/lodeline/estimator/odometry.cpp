#include "lodeline/estimator/odometry.h"

#include "lodeline/base/thread_clock.h"

namespace lodeline {

Odometry::Odometry(const Rig& rig, const OdometryOptions& options, Diagnostics* diagnostics)
    : imu_(rig.imu), front_end_(rig, options.front_end), estimator_(rig, options.estimator, diagnostics) {}

FrameEstimate Odometry::add(const FramePacket& packet) {
  const double start_s = threadSeconds();
  tracks_ = front_end_.process(packet.time, packet.images, previousFromCurrent(packet));
  const double tracked_s = threadSeconds();
  const FrameEstimate estimate = estimator_.add(tracks_, packet.imu, packet.magnetometer, packet.depth);
  times_.front_end_s += tracked_s - start_s;
  times_.estimator_s += threadSeconds() - tracked_s;
  if (estimate.status != Status::Waiting) gyroscope_bias_B_ = estimate.state.gyroscope_bias_B;
  first_ = false;
  return estimate;
}

Quat Odometry::previousFromCurrent(const FramePacket& packet) const {
  if (first_ || packet.imu.size() < 2) return Quat::Identity();
  return Preintegration(packet.imu, gyroscope_bias_B_, Vec3::Zero(), imu_).motion().gamma;
}

}  // namespace lodeline

#include "lodeline/estimator/packet_odometry.h"

#include <fmt/format.h>

#include <algorithm>

#include "lodeline/geometry/so3.h"
#include "lodeline/imu/propagation.h"
#include "lodeline/problem/state/inertial_states.h"
#include "lodeline/util/angles.h"
#include "lodeline/util/thread_clock.h"

namespace lodeline {
namespace {

/// Matches that lie off the planes of a calibration that is held would be of no use to the estimator.
FrontEndOptions frontEndOptions(const Rig& rig, const OdometryOptions& options) {
  FrontEndOptions front_end = options.front_end;
  front_end.detector.max_tracks =
      options.max_tracks > 0 ? options.max_tracks : tracksFor(rig, options.estimator);
  front_end.stereo.learn_rotation &= options.estimator.camera_calibration.enabled;
  return front_end;
}

/// The gyroscope's mean reading between the packet's time and an image `delay_s` later or earlier.
Vec3 meanRate_B(const FramePacket& packet, double delay_s) {
  const std::vector<ImuSample>& readings = delay_s > 0.0 ? packet.imu_ahead : packet.imu;
  const Time other = packet.time + Duration::fromSeconds(delay_s);
  Vec3 sum = packet.imu.back().angular_velocity_B;
  int count = 1;
  for (const ImuSample& sample : readings) {
    if (std::min(packet.time, other) > sample.time || sample.time > std::max(packet.time, other)) continue;
    sum += sample.angular_velocity_B;
    ++count;
  }
  return sum / count;
}

}  // namespace

int tracksFor(const Rig& rig, const EstimatorOptions& options) {
  return optionsFor(rig, options).imu_axes.areDoubted() ? 250 : 180;
}

PacketOdometry::PacketOdometry(const Rig& rig, const OdometryOptions& options, Diagnostics* diagnostics)
    : imu_(rig.imu),
      front_end_(rig, frontEndOptions(rig, options)),
      estimator_(rig, options.estimator, diagnostics),
      static_image_mask_reported_(rig.cameras.size(), false),
      turn_reported_(rig.cameras.size() - 1, false),
      baseline_monitor_(rig),
      stereo_monitor_(rig, diagnostics),
      diagnostics_(diagnostics) {}

FrameEstimate PacketOdometry::add(const FramePacket& packet) {
  const double start_s = threadSeconds();
  const Quat by_gyroscope = previousFromCurrent(packet);
  const Quat steady = steadilyTurning(packet, by_gyroscope);
  const bool is_doubted = estimator_.isGyroscopeDoubted();
  const std::vector<cv::Mat> images = stereo_monitor_.arrange(packet);
  tracks_ = front_end_.process(packet.time, images, is_doubted ? steady : by_gyroscope,
                               is_doubted ? by_gyroscope : steady, motion(packet));
  if (stereo_monitor_.judge(packet, images, tracks_)) {
    front_end_.forgetTracks();
    tracks_ = FrameTracks{packet.time};
  }
  lookForDelays(packet);
  reportStaticImageMask(packet.time);
  reportTurnedCameras();
  const double tracked_s = threadSeconds();
  const FrameEstimate estimate = estimator_.add(tracks_, packet.imu, packet.readings);
  times_.front_end_s += tracked_s - start_s;
  times_.estimator_s += threadSeconds() - tracked_s;
  if (estimate.status != Status::Waiting) follow(estimate.state);
  if (estimate.camera_corrections)
    baseline_monitor_.add(packet.time, *estimate.camera_corrections, diagnostics_);
  first_ = false;
  return estimate;
}

void PacketOdometry::follow(const NavigationState& state) {
  gyroscope_bias_B_ = state.gyroscope_bias_B;
  if (newest_) {
    const Quat turned = newest_->world_from_body.rotation.conjugate() * state.world_from_body.rotation;
    rate_B_ = so3::log(turned) / (state.time - newest_->time).seconds();
  }
  newest_ = state;
}

Quat PacketOdometry::steadilyTurning(const FramePacket& packet, const Quat& by_gyroscope) const {
  if (!newest_ || packet.imu.empty()) return by_gyroscope;
  return so3::exp((packet.time - packet.imu.front().time).seconds() * rate_B_);
}

void PacketOdometry::reportStaticImageMask(Time time) {
  constexpr double kWorthSaying = 0.005;  // less is a particle, left out all the same
  for (size_t i = 0; i < static_image_mask_reported_.size(); ++i) {
    const double share = front_end_.fixedStructures()[i].share();
    if (share < kWorthSaying || static_image_mask_reported_[i]) continue;
    static_image_mask_reported_[i] = true;
    diagnostics_->report(
        Severity::Notice, "static_image_mask",
        fmt::format(
            "camera '{}': {:.1f} % of the image stays the same at {} ns while the rig turns and moves: "
            "parts of the rig, a hood, dirt on the port or characters in the picture; left out from "
            "there on. A mask in the calibration would leave it out from the start",
            front_end_.cameras()[i]->calibration().name, 100.0 * share, time.nanoseconds()));
  }
}

void PacketOdometry::lookForDelays(const FramePacket& packet) {
  constexpr int kEvery = 10;
  constexpr double kLeast_s = 2e-3, kSigmas = 6.0;
  if (++frames_ % kEvery != 0) return;
  for (size_t i = 1; i < front_end_.cameras().size(); ++i) {
    const std::optional<StereoDelay::Estimate> found = front_end_.delay(i).estimate();
    if (!found || std::abs(found->delay_s) < kLeast_s + kSigmas * found->sigma_s) continue;
    front_end_.delay(i).restart();
    found_delay_ = FoundDelay{i, found->delay_s};
    const CameraCalibration& camera = front_end_.cameras()[i]->calibration();
    diagnostics_->report(
        Severity::Warning, "cameras_apart",
        fmt::format(
            "{}: at stamp {} ns its images turn out to be taken {:.1f} ms {} than those of {} that they are "
            "paired with; used so from there on. Trigger both cameras together, or set "
            "timeshift_cam_imu of {} to {:.4f} s",
            camera.name, packet.image_stamp.nanoseconds(), 1e3 * std::abs(found->delay_s),
            found->delay_s > 0.0 ? "later" : "earlier", front_end_.cameras()[0]->calibration().name,
            camera.name, camera.time_offset_to_imu_s + found->delay_s));
  }
}

void PacketOdometry::reportTurnedCameras() {
  for (size_t i = 0; i < tracks_.camera_rotations.size(); ++i) {
    const double turn_rad = tracks_.camera_rotations[i].norm();
    if (turn_rad == 0.0 || turn_reported_[i]) continue;
    turn_reported_[i] = true;
    diagnostics_->report(
        Severity::Warning, "camera_turned",
        fmt::format(
            "camera '{}': at {} ns stereo matches lie off their epipolar lines as if it were turned by "
            "{:.2f} degrees against its calibration, which a lens that is off can do as well; matched "
            "accordingly, and estimated from there on where a start is still to come. Calibrate the pair "
            "anew",
            front_end_.cameras()[i + 1]->calibration().name, tracks_.time.nanoseconds(),
            turn_rad * kDegreesPerRadian));
  }
}

Quat PacketOdometry::previousFromCurrent(const FramePacket& packet) {
  predicted_.reset();
  if (first_ || packet.imu.size() < 2) return Quat::Identity();
  const Vec3 accelerometer_bias_B = newest_ ? newest_->accelerometer_bias_B : Vec3::Zero();
  const Preintegration preintegration(packet.imu, gyroscope_bias_B_, accelerometer_bias_B, imu_);
  if (newest_) predicted_ = predict(*newest_, preintegration, estimator_.options().gravity_W);
  return preintegration.motion().gamma;
}

RigMotion PacketOdometry::motion(const FramePacket& packet) const {
  RigMotion motion;
  if (packet.imu.empty()) return motion;
  motion.rate_B = packet.imu.back().angular_velocity_B - gyroscope_bias_B_;
  if (predicted_)
    motion.velocity_B = predicted_->world_from_body.rotation.conjugate() * predicted_->velocity_W;
  const auto& delays_s = packet.image_delays_s;
  if (std::all_of(delays_s.begin(), delays_s.end(), [](double s) { return s == 0.0; })) return motion;
  for (const double delay_s : delays_s) {
    const Vec3 rate_B = meanRate_B(packet, delay_s) - gyroscope_bias_B_;
    motion.frame_from_image_B.emplace_back(so3::exp(rate_B * delay_s), motion.velocity_B * delay_s);
  }
  return motion;
}

}  // namespace lodeline

#include "lodeline/estimator/odometry.h"

#include <fmt/format.h>

#include "lodeline/base/angles.h"
#include "lodeline/base/thread_clock.h"
#include "lodeline/estimator/inertial_states.h"
#include "lodeline/geometry/so3.h"

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

}  // namespace

int tracksFor(const Rig& rig, const EstimatorOptions& options) {
  return optionsFor(rig, options).imu_axes.areDoubted() ? 250 : 180;
}

Odometry::Odometry(const Rig& rig, const OdometryOptions& options, Diagnostics* diagnostics)
    : imu_(rig.imu),
      front_end_(rig, frontEndOptions(rig, options)),
      estimator_(rig, options.estimator, diagnostics),
      fixed_structure_reported_(rig.cameras.size(), false),
      turn_reported_(rig.cameras.size() - 1, false),
      baseline_watch_(rig),
      diagnostics_(diagnostics) {}

FrameEstimate Odometry::add(const FramePacket& packet) {
  const double start_s = threadSeconds();
  const Quat by_gyroscope = previousFromCurrent(packet);
  const Quat steady = steadilyTurning(packet, by_gyroscope);
  const bool is_doubted = estimator_.isGyroscopeDoubted();
  tracks_ = front_end_.process(packet.time, packet.images, is_doubted ? steady : by_gyroscope,
                               is_doubted ? by_gyroscope : steady);
  reportFixedStructure(packet.time);
  reportTurnedCameras();
  const double tracked_s = threadSeconds();
  const FrameEstimate estimate = estimator_.add(tracks_, packet.imu, packet.magnetometer, packet.depth);
  times_.front_end_s += tracked_s - start_s;
  times_.estimator_s += threadSeconds() - tracked_s;
  if (estimate.status != Status::Waiting) follow(estimate.state);
  if (estimate.camera_corrections)
    baseline_watch_.add(packet.time, *estimate.camera_corrections, diagnostics_);
  first_ = false;
  return estimate;
}

void Odometry::follow(const NavigationState& state) {
  gyroscope_bias_B_ = state.gyroscope_bias_B;
  if (newest_) {
    const Quat turned = newest_->world_from_body.rotation.conjugate() * state.world_from_body.rotation;
    rate_B_ = so3::log(turned) / (state.time - newest_->time).seconds();
  }
  newest_ = state;
}

Quat Odometry::steadilyTurning(const FramePacket& packet, const Quat& by_gyroscope) const {
  if (!newest_ || packet.imu.empty()) return by_gyroscope;
  return so3::exp((packet.time - packet.imu.front().time).seconds() * rate_B_);
}

void Odometry::reportFixedStructure(Time time) {
  constexpr double kWorthSaying = 0.005;  // less is a speck, left out all the same
  for (size_t i = 0; i < fixed_structure_reported_.size(); ++i) {
    const double share = front_end_.fixedStructures()[i].share();
    if (share < kWorthSaying || fixed_structure_reported_[i]) continue;
    fixed_structure_reported_[i] = true;
    diagnostics_->report(
        Severity::Notice, "fixed_structure",
        fmt::format(
            "camera '{}': {:.1f} % of the image stays the same at {} ns while the rig turns and moves: "
            "parts of the rig, a hood, dirt on the port or characters in the picture; left out from "
            "there on. A mask in the calibration would leave it out from the start",
            front_end_.cameras()[i]->calibration().name, 100.0 * share, time.nanoseconds()));
  }
}

void Odometry::reportTurnedCameras() {
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

Quat Odometry::previousFromCurrent(const FramePacket& packet) const {
  if (first_ || packet.imu.size() < 2) return Quat::Identity();
  return Preintegration(packet.imu, gyroscope_bias_B_, Vec3::Zero(), imu_).motion().gamma;
}

}  // namespace lodeline

#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "lodeline/estimator/estimator.h"
#include "lodeline/estimator/monitoring/stereo_monitor.h"
#include "lodeline/estimator/self_calibration/baseline_monitor.h"
#include "lodeline/frontend/front_end.h"
#include "lodeline/io/synchronizer/frame_packet.h"

namespace lodeline {

struct OdometryOptions {
  FrontEndOptions front_end;
  EstimatorOptions estimator;
  /// Points followed at a time, in place of front_end.detector.max_tracks; 0: tracksFor().
  int max_tracks = 0;
};

/// Points worth following with a rig's IMU: heading hangs on images alone where the gyroscope is loud or of
/// doubtful axes, and takes more of them.
int tracksFor(const Rig& rig, const EstimatorOptions& options);

/// Processor time spent in each stage so far, s.
struct StageTimes {
  double front_end_s = 0.0;
  double estimator_s = 0.0;
};

/// A secondary camera that turns out to take its images later than their stamps say.
struct FoundDelay {
  size_t camera = 0;
  double delay_s = 0.0;
};

/// The whole way from a packet of measurements to an estimate.
class PacketOdometry {
 public:
  /// `diagnostics` must outlive the odometry.
  PacketOdometry(const Rig& rig, const OdometryOptions& options, Diagnostics* diagnostics);

  /// Adds one packet of the synchronizer; packets must come in order.
  FrameEstimate add(const FramePacket& packet);

  /// A delay found since the last call, to be taken into account by whoever makes the packets
  /// (Synchronizer::delayCamera). Without that it is reported, no more.
  std::optional<FoundDelay> takeDelay() { return std::exchange(found_delay_, std::nullopt); }

  /// Reports what can only be said of the whole run.
  void finish() { stereo_monitor_.finish(); }

  Estimator& estimator() { return estimator_; }
  const Estimator& estimator() const { return estimator_; }
  const FrontEnd& frontEnd() const { return front_end_; }
  /// What the front end followed in the newest packet.
  const FrameTracks& tracks() const { return tracks_; }
  const StageTimes& times() const { return times_; }

 private:
  /// The gyroscope's rotation over the packet; none for the first one.
  Quat previousFromCurrent(const FramePacket& packet);
  /// Between the frame's time and those of the images; at rest before there is an estimate.
  RigMotion motion(const FramePacket& packet) const;
  /// That of a body that goes on turning as the estimate has it, in place of the gyroscope's where that is
  /// doubted.
  Quat steadilyTurning(const FramePacket& packet, const Quat& by_gyroscope) const;
  void follow(const NavigationState& state);
  /// Of each camera once.
  void reportStaticImageMask(Time time);
  void reportTurnedCameras();
  void lookForDelays(const FramePacket& packet);

  ImuCalibration imu_;
  FrontEnd front_end_;
  FrameTracks tracks_;
  Estimator estimator_;
  Vec3 gyroscope_bias_B_ = Vec3::Zero();
  std::optional<NavigationState> newest_;     ///< of the last frame that has a pose
  std::optional<NavigationState> predicted_;  ///< at the packet's time
  Vec3 rate_B_ = Vec3::Zero();                ///< that led to newest_, rad/s
  bool first_ = true;
  std::vector<bool> static_image_mask_reported_;
  std::vector<bool> turn_reported_;  ///< of camera 1, 2, ...
  BaselineMonitor baseline_monitor_;
  StereoMonitor stereo_monitor_;
  std::optional<FoundDelay> found_delay_;
  int frames_ = 0;
  Diagnostics* diagnostics_;
  StageTimes times_;
};

}  // namespace lodeline

#pragma once

#include <optional>
#include <vector>

#include "lodeline/data/frame_packet.h"
#include "lodeline/estimator/baseline_watch.h"
#include "lodeline/estimator/estimator.h"
#include "lodeline/features/front_end.h"

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

/// The whole way from a packet of measurements to an estimate.
class Odometry {
 public:
  /// `diagnostics` must outlive the odometry.
  Odometry(const Rig& rig, const OdometryOptions& options, Diagnostics* diagnostics);

  /// Adds one packet of the synchroniser; packets must come in order.
  FrameEstimate add(const FramePacket& packet);

  Estimator& estimator() { return estimator_; }
  const Estimator& estimator() const { return estimator_; }
  const FrontEnd& frontEnd() const { return front_end_; }
  /// What the front end followed in the newest packet.
  const FrameTracks& tracks() const { return tracks_; }
  const StageTimes& times() const { return times_; }

 private:
  /// The gyroscope's rotation over the packet; none for the first one.
  Quat previousFromCurrent(const FramePacket& packet) const;
  /// That of a body that goes on turning as the estimate has it, in place of the gyroscope's where that is
  /// doubted.
  Quat steadilyTurning(const FramePacket& packet, const Quat& by_gyroscope) const;
  void follow(const NavigationState& state);
  /// Of each camera once.
  void reportFixedStructure(Time time);
  void reportTurnedCameras();

  ImuCalibration imu_;
  FrontEnd front_end_;
  FrameTracks tracks_;
  Estimator estimator_;
  Vec3 gyroscope_bias_B_ = Vec3::Zero();
  std::optional<NavigationState> newest_;  ///< of the last frame that has a pose
  Vec3 rate_B_ = Vec3::Zero();             ///< that led there, rad/s
  bool first_ = true;
  std::vector<bool> fixed_structure_reported_;
  std::vector<bool> turn_reported_;  ///< of camera 1, 2, ...
  BaselineWatch baseline_watch_;
  Diagnostics* diagnostics_;
  StageTimes times_;
};

}  // namespace lodeline

#pragma once

#include "lodeline/ahrs/attitude_filter.h"
#include "lodeline/io/synchronizer/frame_packet.h"

namespace lodeline {

/// The attitude filter beside an odometry: knows roll, pitch and, with a magnetometer, heading before the
/// first pose and whenever images are lost. It takes nothing from the odometry and gives it nothing.
class AttitudeTrack {
 public:
  /// `diagnostics` must outlive the track.
  AttitudeTrack(const Rig& rig, const AttitudeFilterOptions& options, Diagnostics* diagnostics)
      : filter_(options, rig.magnetometer, diagnostics) {}

  /// Attitude at the packet's time, in axes east, north, up of the magnetometer's north (true north where the
  /// options know the site), without a magnetometer with the heading of the first attitude as zero. Nothing
  /// before the first inertial reading.
  const std::optional<AttitudeEstimate>& add(const FramePacket& packet);

 private:
  AttitudeFilter filter_;
  std::optional<Time> last_;
};

}  // namespace lodeline

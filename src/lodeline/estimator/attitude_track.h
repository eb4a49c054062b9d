#pragma once

#include "lodeline/ahrs/attitude_filter.h"
#include "lodeline/io/synchronizer/frame_packet.h"

namespace lodeline {

/// Attitude filter beside an odometry. It estimates roll, pitch and, with a magnetometer, heading before the
/// first pose and whenever images are lost. It is independent of the odometry in both directions.
class AttitudeTrack {
 public:
  /// `diagnostics` must outlive the track.
  AttitudeTrack(const Rig& rig, const AttitudeFilterOptions& options, Diagnostics* diagnostics)
      : filter_(options, rig.magnetometer, diagnostics) {}

  /// Attitude at the packet's time. Axes: east, north, up with the magnetometer's north (true north where the
  /// options contain the site). Without a magnetometer, the heading of the first attitude is zero. Empty
  /// before the first inertial reading.
  const std::optional<AttitudeEstimate>& add(const FramePacket& packet);

 private:
  AttitudeFilter filter_;
  std::optional<Time> last_;
};

}  // namespace lodeline

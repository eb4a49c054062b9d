#include "lodeline/estimator/attitude_track.h"

namespace lodeline {

const std::optional<AttitudeEstimate>& AttitudeTrack::add(const FramePacket& packet) {
  auto field = packet.magnetometer.begin();
  for (const ImuSample& sample : packet.imu) {
    // A packet begins with the last reading of the packet before.
    if (last_ && sample.time <= *last_) continue;
    last_ = sample.time;
    filter_.add(sample);
    for (; field != packet.magnetometer.end() && field->time <= sample.time; ++field) filter_.add(*field);
  }
  for (; field != packet.magnetometer.end(); ++field) filter_.add(*field);
  return filter_.estimate();
}

}  // namespace lodeline

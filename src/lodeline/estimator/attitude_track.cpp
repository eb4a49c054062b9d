#include "lodeline/estimator/attitude_track.h"

namespace lodeline {

const std::optional<AttitudeEstimate>& AttitudeTrack::add(const FramePacket& packet) {
  const std::vector<MagnetometerSample>& fields = packet.readings.of<MagnetometerSample>();
  auto field = fields.begin();
  for (const ImuSample& sample : packet.imu) {
    // A packet begins with the last reading of the packet before.
    if (last_ && sample.time <= *last_) continue;
    last_ = sample.time;
    filter_.add(sample);
    for (; field != fields.end() && field->time <= sample.time; ++field) filter_.add(*field);
  }
  for (; field != fields.end(); ++field) filter_.add(*field);
  return filter_.estimate();
}

}  // namespace lodeline

#include "lodeline/io/rosbag/imu_content.h"

#include "lodeline/io/rosbag/checked_reading.h"
#include "lodeline/io/rosbag/messages.h"

namespace lodeline {

ImuContent contentOf(const BagTopic& topic, BagFile* bag) {
  ImuContent content;
  for (const BagEntry& entry : topic.entries) {
    const std::optional<wire::Bytes> message = bag->read(topic, entry);
    std::string problem;
    const std::optional<ImuSample> sample =
        message ? messages::checkedReading(*message, messages::parseImu, &problem) : std::nullopt;
    if (!sample) continue;
    content.has_gyroscope = content.has_gyroscope || !sample->angular_velocity_B.isZero(0.0);
    content.has_accelerometer = content.has_accelerometer || !sample->specific_force_B.isZero(0.0);
    if (content.isWhole()) break;
  }
  return content;
}

}  // namespace lodeline

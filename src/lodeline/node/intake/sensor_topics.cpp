#include "lodeline/node/intake/sensor_topics.h"

#include <fmt/format.h>

#include <algorithm>

#include "lodeline/diagnostics.h"
#include "lodeline/sensors/sensor_kind.h"

namespace lodeline {
namespace {

constexpr const char* kImu = "imu0";

std::vector<std::string> sensorsOf(const Rig& rig) {
  std::vector<std::string> sensors = {kImu};
  for (const CameraCalibration& camera : rig.cameras) sensors.push_back(camera.name);
  forEachSensorKind([&](auto kind) {
    if (rig.*kind.calibration) sensors.emplace_back(kind.section);
  });
  return sensors;
}

bool isCameraName(const std::string& sensor) { return sensor.starts_with("cam"); }

}  // namespace

bool SensorTopic::isCamera() const { return isCameraName(sensor); }

std::map<std::string, std::string> chooseLiveTopics(const RigFile& rig_file,
                                                    const std::map<std::string, std::string>& named,
                                                    Rig* rig) {
  const std::vector<std::string> sensors = sensorsOf(*rig);
  for (const auto& [sensor, topic] : named) {
    if (std::find(sensors.begin(), sensors.end(), sensor) == sensors.end()) {
      throw UsageError(
          fmt::format("topic {} of {}: the rig files describe no such sensor that the run uses; they have {}",
                      topic, sensor, fmt::join(sensors, ", ")));
    }
  }
  std::map<std::string, std::string> topics;
  for (const std::string& sensor : sensors) {
    if (const auto given = named.find(sensor); given != named.end()) {
      topics[sensor] = given->second;
    } else if (const auto known = rig_file.topics.find(sensor); known != rig_file.topics.end()) {
      topics[sensor] = known->second;
    } else if (sensor == kImu || isCameraName(sensor)) {
      throw InputError(
          fmt::format("no topic is known for {}; name it with `topic` in its section of the rig file, or in "
                      "the option for topics",
                      sensor));
    }
  }
  forEachSensorKind([&](auto kind) {
    if (!topics.contains(kind.section)) (rig->*kind.calibration).reset();
  });
  return topics;
}

std::vector<SensorTopic> subscriptionsOf(const std::map<std::string, std::string>& topics) {
  std::vector<SensorTopic> subscriptions;
  const auto subscribe = [&](const std::string& sensor, const std::string& topic, bool is_half) {
    for (const SensorTopic& other : subscriptions) {
      if (other.topic == topic)
        throw UsageError(fmt::format("topic {} is named for {} and {}", topic, other.sensor, sensor));
    }
    subscriptions.push_back({sensor, topic, messages::namedTypesOf(sensor), is_half});
  };
  for (const auto& [sensor, topic] : topics) {
    const size_t comma = topic.find(',');
    const bool is_divided = comma != std::string::npos;
    if (is_divided && sensor != kImu) {
      throw UsageError(fmt::format("topic {} of {}: only an IMU has two topics", topic, sensor));
    }
    subscribe(sensor, topic.substr(0, comma), is_divided);
    if (is_divided) subscribe(sensor, topic.substr(comma + 1), true);
  }
  return subscriptions;
}

}  // namespace lodeline

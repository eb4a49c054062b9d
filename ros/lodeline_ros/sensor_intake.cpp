#include "lodeline_ros/sensor_intake.h"

#include <fmt/format.h>
#include <ros/console.h>

#include <algorithm>

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/checked_reading.h"
#include "lodeline/io/rosbag/image_messages.h"
#include "lodeline/io/rosbag/messages.h"

namespace lodeline {
namespace {

// Queue lengths in ROS until the callback thread runs; that thread never waits.
constexpr uint32_t kImageQueue = 100;
constexpr uint32_t kReadingQueue = 5000;

bool isCamera(const std::string& sensor) { return sensor.starts_with("cam"); }

std::string header(const ros::MessageEvent<const RawMessage>& event, const char* field) {
  const auto found = event.getConnectionHeader().find(field);
  return found == event.getConnectionHeader().end() ? std::string() : found->second;
}

bool isOf(const ros::MessageEvent<const RawMessage>& event, const messages::Type& type) {
  return header(event, "type") == type.name && header(event, "md5sum") == type.md5sum;
}

std::vector<std::string> sensorsOf(const Rig& rig) {
  std::vector<std::string> sensors = {"imu0"};
  for (const CameraCalibration& camera : rig.cameras) sensors.push_back(camera.name);
  if (rig.magnetometer) sensors.emplace_back("mag0");
  if (rig.pressure) sensors.emplace_back("pressure0");
  return sensors;
}

}  // namespace

std::map<std::string, std::string> chooseLiveTopics(const RigFile& rig_file,
                                                    const std::map<std::string, std::string>& named,
                                                    Rig* rig) {
  const std::vector<std::string> sensors = sensorsOf(*rig);
  for (const auto& [sensor, topic] : named) {
    if (std::find(sensors.begin(), sensors.end(), sensor) == sensors.end()) {
      throw UsageError(
          fmt::format("~topics/{}: the rig files describe no such sensor that the node uses; "
                      "they have {}",
                      sensor, fmt::join(sensors, ", ")));
    }
  }
  std::map<std::string, std::string> topics;
  for (const std::string& sensor : sensors) {
    if (const auto told = named.find(sensor); told != named.end()) {
      topics[sensor] = told->second;
    } else if (const auto known = rig_file.topics.find(sensor); known != rig_file.topics.end()) {
      topics[sensor] = known->second;
    } else if (sensor == "imu0" || isCamera(sensor)) {
      throw InputError(
          fmt::format("no topic is known for {}; name it with `topic` in its section of the rig "
                      "file, or with the parameter ~topics/{}",
                      sensor, sensor));
    }
  }
  if (!topics.contains("mag0")) rig->magnetometer.reset();
  if (!topics.contains("pressure0")) rig->pressure.reset();
  rig->sonar.reset();  // LiveSource has no stream of it
  return topics;
}

SensorIntake::SensorIntake(ros::NodeHandle node, const std::map<std::string, std::string>& topics,
                           const WaterColumn& water, LiveSource* source)
    : node_(std::move(node)), source_(source) {
  for (const auto& [sensor, topic] : topics) {
    subscribe(sensor, topic, isCamera(sensor) ? kImageQueue : kReadingQueue, pushFor(sensor, topic, water));
  }
}

SensorIntake::Push SensorIntake::pushFor(const std::string& sensor, const std::string& topic,
                                         const WaterColumn& water) {
  const auto reading = [this](auto parse) -> Push {
    return [this, parse](const Event& event, std::string* problem) {
      const auto sample = messages::checkedReading(event.getMessage()->bytes, parse, problem);
      if (sample) source_->push(*sample);
    };
  };
  if (sensor == "imu0") return reading(messages::parseImu);
  if (sensor == "mag0") return reading(messages::parseMagneticField);
  if (sensor == "pressure0") {
    return reading(
        [water](std::span<const uint8_t> message) { return messages::parseFluidPressure(message, water); });
  }
  const std::vector<CameraCalibration>& cameras = source_->rig().cameras;
  const auto camera = std::find_if(cameras.begin(), cameras.end(), [&](const CameraCalibration& candidate) {
    return candidate.name == sensor;
  });
  const auto place = static_cast<size_t>(camera - cameras.begin());
  return [this, place, topic](const Event& event, std::string*) {
    const bool is_compressed = isOf(event, messages::kCompressedImage);
    source_->push(place, messages::pendingImage(
                             is_compressed ? messages::ImageForm::Compressed : messages::ImageForm::Raw,
                             event.getMessage()->bytes, topic));
  };
}

void SensorIntake::subscribe(const std::string& sensor, const std::string& topic, uint32_t queue_size,
                             const Push& push) {
  const std::vector<messages::Type> types = messages::typesOf(sensor);
  const boost::function<void(const Event&)> callback = [sensor, topic, types, push](const Event& event) {
    std::string problem;
    if (std::none_of(types.begin(), types.end(),
                     [&](const messages::Type& type) { return isOf(event, type); })) {
      problem = fmt::format("is of type {} (definition {}), which {} does not have", header(event, "type"),
                            header(event, "md5sum"), sensor);
    } else {
      try {
        push(event, &problem);
      } catch (const wire::Reader::CutOff& error) {
        problem = error.what();
      }
    }
    if (!problem.empty())
      ROS_WARN_THROTTLE(10.0, "%s: a message %s; passed over", topic.c_str(), problem.c_str());
  };
  constexpr const char* kAny = "*";
  ros::SubscribeOptions options(topic, queue_size, kAny, kAny);
  options.helper = boost::make_shared<ros::SubscriptionCallbackHelperT<const Event&>>(callback);
  options.transport_hints = ros::TransportHints().tcpNoDelay();
  subscribers_.push_back(node_.subscribe(options));
}

}  // namespace lodeline

#include "lodeline/node/intake/message_intake.h"

#include <fmt/format.h>

#include <algorithm>

#include "lodeline/io/rosbag/checked_reading.h"
#include "lodeline/io/rosbag/image_messages.h"
#include "lodeline/io/rosbag/robots/current_messages.h"
#include "lodeline/io/rosbag/robots/dvl_messages.h"

namespace lodeline {
namespace {

/// Place of a camera in a rig.
size_t cameraOf(const SensorTopic& topic, const Rig& rig) {
  const auto camera =
      std::find_if(rig.cameras.begin(), rig.cameras.end(),
                   [&](const CameraCalibration& candidate) { return candidate.name == topic.sensor; });
  return static_cast<size_t>(camera - rig.cameras.begin());
}

}  // namespace

using definitions::Serialization;

MessageIntake::MessageIntake(std::vector<SensorTopic> topics, const WaterColumn& water,
                             Serialization serialization, LiveSource* source)
    : topics_(std::move(topics)), water_(water), source_(source) {
  for (const SensorTopic& topic : topics_) {
    SensorTraffic traffic;
    traffic.sensor = topic.sensor;
    traffic.topic = topic.topic;
    traffic_.push_back(std::move(traffic));
    cameras_.push_back(cameraOf(topic, source->rig()));
    if (serialization == Serialization::Ros1) continue;
    for (const messages::Type& type : topic.types) {
      to_ros1_[type.name] = std::make_unique<const definitions::MessageConversion>(
          definitions::knownForm(type.name, Serialization::Cdr),
          definitions::knownForm(type.name, Serialization::Ros1));
    }
  }
}

const messages::Type* MessageIntake::typeOf(const SensorTopic& topic, const std::string& type,
                                            const std::string& md5sum) {
  const auto found =
      std::find_if(topic.types.begin(), topic.types.end(), [&](const messages::Type& accepted) {
        return type == accepted.name && (md5sum.empty() || md5sum == accepted.md5sum);
      });
  return found == topic.types.end() ? nullptr : &*found;
}

void MessageIntake::receive(size_t place, const std::string& type, const std::string& md5sum,
                            wire::Bytes message) {
  const SensorTopic& topic = topics_[place];
  std::string problem;
  if (typeOf(topic, type, md5sum) == nullptr) {
    problem = fmt::format("is of type {} {}, which {} does not have", type, md5sum, topic.sensor);
  } else {
    try {
      push(place, type, inRos1(type, std::move(message)), &problem);
    } catch (const wire::Reader::CutOff& error) {
      problem = error.what();
    } catch (const definitions::DefinitionError& error) {
      problem = error.what();
    } catch (const InputError& error) {  // other channels of currents than those of the rig
      problem = error.what();
    }
  }
  const std::lock_guard lock(mutex_);
  SensorTraffic& traffic = traffic_[place];
  ++traffic.received;
  if (problem.empty()) return;
  ++traffic.unusable;
  traffic.problem = problem;
}

wire::Bytes MessageIntake::inRos1(const std::string& type, wire::Bytes message) const {
  const auto conversion = to_ros1_.find(type);
  return conversion == to_ros1_.end() ? message : conversion->second->convert(message);
}

void MessageIntake::push(size_t place, const std::string& type, wire::Bytes message, std::string* problem) {
  const SensorTopic& topic = topics_[place];
  const auto pushReading = [&](auto parse) {
    if (const auto sample = messages::checkedReading(message, parse, problem)) source_->push(*sample);
  };
  if (topic.isCamera()) {
    const auto form =
        type == messages::kCompressedImage.name ? messages::ImageForm::Compressed : messages::ImageForm::Raw;
    source_->push(cameras_[place], messages::pendingImage(form, std::move(message), topic.topic));
  } else if (topic.sensor == "imu0") {
    pushImu(topic, message, problem);
  } else if (topic.sensor == "mag0") {
    pushReading(messages::parseMagneticField);
  } else if (topic.sensor == "sonar0") {
    const bool is_scan = type == messages::kLaserScan.name;
    const auto echoes =
        messages::checkedReading(message, is_scan ? messages::parseLaserScan : messages::parseRange, problem);
    for (const SonarSample& echo : echoes.value_or(std::vector<SonarSample>())) source_->push(echo);
  } else if (topic.sensor == "altimeter0") {
    const auto echoes = messages::checkedReading(message, messages::parseAltimeter, problem);
    for (const AltimeterSample& echo : echoes.value_or(std::vector<AltimeterSample>())) source_->push(echo);
  } else if (topic.sensor == "dvl0") {
    const auto parse = [&](std::span<const uint8_t> bytes) { return messages::parseDvl(type, bytes); };
    const auto reading = messages::checkedReading(message, parse, problem);
    if (reading) pushDvl(withoutSentinels(reading->ping));
  } else if (topic.sensor == "current0") {
    const auto parse = [&](std::span<const uint8_t> bytes) { return messages::parseCurrents(type, bytes); };
    const auto currents = messages::checkedReading(message, parse, problem);
    const std::vector<std::string>& channels = source_->rig().currents->channels;
    if (channels.empty()) throw InputError("the rig names no `channels` of current0");
    if (currents) source_->push(messages::inOrder("the message", *currents, channels));
  } else if (type == messages::kOdometry.name) {
    pushReading(messages::parseOdometryDepth);
  } else {
    pushReading(
        [this](std::span<const uint8_t> bytes) { return messages::parseFluidPressure(bytes, water_); });
  }
}

void MessageIntake::pushDvl(DvlSample sample) {
  const size_t beams = source_->rig().dvl->beams_D.size();
  std::erase_if(sample.beams, [&](const DvlBeam& beam) {
    return beam.index < 0 || static_cast<size_t>(beam.index) >= beams;
  });
  source_->push(sample);
}

void MessageIntake::pushImu(const SensorTopic& topic, std::span<const uint8_t> message,
                            std::string* problem) {
  const std::optional<ImuSample> sample = messages::checkedReading(message, messages::parseImu, problem);
  if (!sample) return;
  if (!topic.is_half) return source_->push(*sample);
  const std::lock_guard lock(halves_mutex_);
  const size_t dropped = halves_.dropped();
  halves_.add(*sample);
  while (const std::optional<ImuSample> whole = halves_.next()) source_->push(*whole);
  if (halves_.dropped() > dropped) *problem = "waited too long for the other half of the IMU";
}

void MessageIntake::addLost(size_t topic, uint64_t messages) {
  const std::lock_guard lock(mutex_);
  traffic_[topic].lost += messages;
}

void MessageIntake::addProblem(size_t topic, const std::string& problem) {
  const std::lock_guard lock(mutex_);
  ++traffic_[topic].unusable;
  traffic_[topic].problem = problem;
}

std::vector<SensorTraffic> MessageIntake::traffic() const {
  const std::lock_guard lock(mutex_);
  return traffic_;
}

}  // namespace lodeline

#include "lodeline/io/rosbag/topic_choice.h"

#include <fmt/core.h>

#include <algorithm>

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/imu_content.h"
#include "lodeline/io/rosbag/messages.h"
#include "lodeline/sensors/sensor_kind.h"

namespace lodeline {
namespace {

using messages::Type;
using messages::typesOf;

bool isOf(const BagTopic& topic, const std::vector<Type>& types) {
  return std::any_of(types.begin(), types.end(), [&](const Type& type) {
    return topic.connection.type == type.name && topic.connection.md5sum == type.md5sum;
  });
}

std::string listTopics(const BagFile& bag) {
  std::string text = "the bag has";
  const char* separator = " ";
  for (const BagTopic& topic : bag.topics()) {
    text += fmt::format("{}{} ({}, {})", separator, topic.connection.topic, topic.connection.type,
                        topic.entries.size());
    separator = ", ";
  }
  return text;
}

const BagTopic* findNamed(const BagFile& bag, const std::string& sensor, const std::string& name) {
  const std::vector<Type> types = messages::namedTypesOf(sensor);
  const BagTopic* other = nullptr;
  for (const BagTopic& topic : bag.topics()) {
    if (topic.connection.topic != name && topic.connection.topic != "/" + name) continue;
    if (isOf(topic, types)) return &topic;
    other = &topic;
  }
  if (other == nullptr) {
    throw InputError(
        fmt::format("{}: has no topic {} for {}; {}", bag.file().string(), name, sensor, listTopics(bag)));
  }
  if (!other->connection.problem.empty()) {
    throw InputError(fmt::format("{}: topic {} for {} ({}) cannot be decoded: {}", bag.file().string(),
                                 other->connection.topic, sensor, other->connection.type,
                                 other->connection.problem));
  }
  throw InputError(fmt::format("{}: topic {} for {} is of type {} (definition {}), which {} does not have",
                               bag.file().string(), name, sensor, other->connection.type,
                               other->connection.md5sum, sensor));
}

/// The camera of a topic: "/cam0/image_raw/compressed" is another form of "/cam0/image_raw".
std::string cameraOf(const BagTopic& topic) {
  const std::string& name = topic.connection.topic;
  constexpr std::string_view kSuffix = "/compressed";
  return name.ends_with(kSuffix) ? name.substr(0, name.size() - kSuffix.size()) : name;
}

class Chooser {
 public:
  Chooser(BagFile* bag, const TopicWish& wish, Diagnostics* diagnostics)
      : bag_(*bag), wish_(wish), diagnostics_(diagnostics) {}

  TopicChoice run() {
    takeNamed();
    chooseCameras();
    for (const std::string& sensor : wish_.sensors) chooseSensor(sensor);
    requireWholeImu();
    reportUnused();
    return std::move(choice_);
  }

 private:
  static constexpr const char* kLeaveOut =
      "; cameras that the bag lacks can be left out, e.g. --set source.cameras=[0,1]";

  bool isChosen(const BagTopic* topic) const {
    return std::any_of(choice_.topics.begin(), choice_.topics.end(),
                       [&](const auto& entry) { return entry.second == topic; });
  }

  bool isWanted(const std::string& sensor) const {
    return std::find(wish_.cameras.begin(), wish_.cameras.end(), sensor) != wish_.cameras.end() ||
           std::find(wish_.sensors.begin(), wish_.sensors.end(), sensor) != wish_.sensors.end();
  }

  void takeNamed() {
    for (const auto& [sensor, name] : wish_.named) {
      const size_t comma = name.find(',');
      if (sensor == "imu0" && comma != std::string::npos) {
        takeHalves(findNamed(bag_, sensor, name.substr(0, comma)),
                   findNamed(bag_, sensor, name.substr(comma + 1)));
        continue;
      }
      try {
        choice_.topics[sensor] = findNamed(bag_, sensor, name);
      } catch (const InputError& error) {
        choice_.topics.erase(sensor);
        if (!isWanted(sensor)) continue;
        const bool is_camera = sensor.starts_with("cam") && wish_.rig_cameras.size() > 1;
        throw InputError(std::string(error.what()) + (is_camera ? kLeaveOut : ""));
      }
    }
  }

  void take(const std::string& sensor, const BagTopic* topic) {
    choice_.topics[sensor] = topic;
    diagnostics_->report(Severity::Notice, "bag_topic",
                         fmt::format("{}: {} is taken from {}, found by its type", bag_.file().string(),
                                     sensor, topic->connection.topic));
  }

  std::vector<std::string> without(const std::vector<std::string>& cameras) const {
    std::vector<std::string> missing;
    for (const std::string& sensor : cameras) {
      if (choice_.of(sensor) == nullptr) missing.push_back(sensor);
    }
    return missing;
  }

  void chooseCameras() {
    if (without(wish_.cameras).empty()) return;
    std::vector<const BagTopic*> free = imageTopics(bag_);
    std::erase_if(free, [&](const BagTopic* topic) { return isChosen(topic); });
    // A bag has the images of all cameras, or only of those to be used.
    std::vector<std::string> missing = without(wish_.rig_cameras);
    if (free.size() != missing.size()) missing = without(wish_.cameras);
    if (free.size() != missing.size()) {
      throw InputError(
          fmt::format("{}: {} topics of images for {} cameras; name them with `topic` in the rig "
                      "file or --topic cam0=/…{}; {}",
                      bag_.file().string(), free.size(), missing.size(),
                      free.size() < missing.size() ? kLeaveOut : "", listTopics(bag_)));
    }
    for (size_t i = 0; i < missing.size(); ++i) take(missing[i], free[i]);
  }

  /// Whether a topic is chosen for another sensor, or has the first type of a sensor without topic but not of
  /// this one: a Range is an altimeter's, where the rig has one, and otherwise a sonar's.
  bool isRatherOfOther(const BagTopic& topic, const std::string& sensor) const {
    const auto hasFirstTypeOf = [&](const std::string& other) {
      return topic.connection.type == typesOf(other).front().name;
    };
    if (isChosen(&topic)) return true;
    return !hasFirstTypeOf(sensor) &&
           std::any_of(wish_.sensors.begin(), wish_.sensors.end(), [&](const std::string& other) {
             return choice_.of(other) == nullptr && hasFirstTypeOf(other);
           });
  }

  void chooseSensor(const std::string& sensor) {
    if (choice_.of(sensor) != nullptr) return;
    std::vector<const BagTopic*> found = topicsFor(bag_, sensor);
    std::erase_if(found, [&](const BagTopic* topic) { return isRatherOfOther(*topic, sensor); });
    if (found.empty()) return;
    if (found.size() > 1 && sensor == "imu0") found = wholeOrHalves(found);
    if (found.size() > 1) {
      throw InputError(
          fmt::format("{}: {} topics could be {} ({}, {}, …); name one with `topic` in the rig file "
                      "or --topic {}=/…",
                      bag_.file().string(), found.size(), sensor, found[0]->connection.topic,
                      found[1]->connection.topic, sensor));
    }
    if (choice_.of(sensor) == nullptr) take(sensor, found.front());
  }

  /// The complete ones among several IMUs; if there is none, the two topics of a divided IMU.
  std::vector<const BagTopic*> wholeOrHalves(const std::vector<const BagTopic*>& found) {
    std::vector<const BagTopic*> whole, gyroscopes, accelerometers;
    for (const BagTopic* topic : found) {
      const ImuContent content = contentOf(*topic, &bag_);
      if (content.isWhole()) {
        whole.push_back(topic);
      } else if (content.has_gyroscope) {
        gyroscopes.push_back(topic);
      } else if (content.has_accelerometer) {
        accelerometers.push_back(topic);
      }
    }
    if (!whole.empty()) return whole;
    if (gyroscopes.size() != 1 || accelerometers.size() != 1) return found;
    takeHalves(gyroscopes[0], accelerometers[0]);
    return gyroscopes;
  }

  void takeHalves(const BagTopic* one, const BagTopic* other) {
    const ImuContent first = contentOf(*one, &bag_), second = contentOf(*other, &bag_);
    const bool is_swapped = !first.has_gyroscope && second.has_gyroscope;
    const BagTopic* gyroscope = is_swapped ? other : one;
    const BagTopic* accelerometer = is_swapped ? one : other;
    if (one == other || !(is_swapped ? second : first).has_gyroscope ||
        !(is_swapped ? first : second).has_accelerometer) {
      throw InputError(
          fmt::format("{}: {} and {} are not the gyroscope and the accelerometer of an IMU: one of "
                      "the two is zero throughout in both",
                      bag_.file().string(), one->connection.topic, other->connection.topic));
    }
    choice_.topics["imu0"] = gyroscope;
    choice_.accelerometer = accelerometer;
    diagnostics_->report(
        Severity::Notice, "imu_united",
        fmt::format("{}: imu0 is united from {} (gyroscope) and {} (accelerometer, interpolated to the "
                    "gyroscope's stamps)",
                    bag_.file().string(), gyroscope->connection.topic, accelerometer->connection.topic));
  }

  void requireWholeImu() {
    const BagTopic* imu = choice_.of("imu0");
    if (imu == nullptr || choice_.accelerometer != nullptr) return;
    const ImuContent content = contentOf(*imu, &bag_);
    if (content.isWhole()) return;
    const char* absent = content.has_gyroscope ? "specific force" : "angular velocity";
    std::string advice = "record gyroscope and accelerometer";
    for (const BagTopic* topic : topicsFor(bag_, "imu0")) {
      const ImuContent other = contentOf(*topic, &bag_);
      if (topic == imu || (content.has_gyroscope ? !other.has_accelerometer : !other.has_gyroscope)) continue;
      advice =
          fmt::format("--topic imu0={},{} unites the halves", imu->connection.topic, topic->connection.topic);
    }
    throw InputError(fmt::format("{}: topic {} is no whole IMU: its {} is zero throughout; {}",
                                 bag_.file().string(), imu->connection.topic, absent, advice));
  }

  void reportUnused() {
    for (const std::string sensor : kSingleSensors) {
      if (sensor == "imu0" || choice_.of(sensor) != nullptr) continue;
      for (const BagTopic* topic : topicsFor(bag_, sensor)) {
        if (isChosen(topic)) continue;
        diagnostics_->report(
            Severity::Notice, "bag_topic_unused",
            fmt::format("{}: topic {} ({}) is not used: the rig file has no section {}", bag_.file().string(),
                        topic->connection.topic, topic->connection.type, sensor));
      }
    }
  }

  BagFile& bag_;
  const TopicWish& wish_;
  Diagnostics* diagnostics_;
  TopicChoice choice_;
};

}  // namespace

std::vector<const BagTopic*> imageTopics(const BagFile& bag) {
  std::map<std::string, const BagTopic*> by_camera;
  for (const BagTopic& topic : bag.topics()) {
    if (!isOf(topic, typesOf("cam0"))) continue;
    const BagTopic*& known = by_camera[cameraOf(topic)];
    if (known == nullptr || topic.connection.type == messages::kImage.name) known = &topic;
  }
  std::vector<const BagTopic*> topics;
  for (const auto& [camera, topic] : by_camera) topics.push_back(topic);
  return topics;
}

std::vector<const BagTopic*> topicsFor(const BagFile& bag, const std::string& sensor) {
  const std::vector<Type> types = typesOf(sensor);
  std::vector<const BagTopic*> found;
  for (const BagTopic& topic : bag.topics()) {
    if (isOf(topic, types)) found.push_back(&topic);
  }
  return found;
}

TopicChoice chooseTopics(BagFile* bag, const TopicWish& wish, Diagnostics* diagnostics) {
  return Chooser(bag, wish, diagnostics).run();
}

}  // namespace lodeline

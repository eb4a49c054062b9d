#include "lodeline/bags/topic_choice.h"

#include <fmt/core.h>

#include <algorithm>

#include "lodeline/bags/messages.h"
#include "lodeline/base/error.h"

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
  const std::vector<Type> types = typesOf(sensor);
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
  throw InputError(fmt::format("{}: topic {} for {} is of type {} (definition {}), which {} does not have",
                               bag.file().string(), name, sensor, other->connection.type,
                               other->connection.md5sum, sensor));
}

/// "/cam0/image_raw/compressed" is "/cam0/image_raw" in another form.
std::string cameraOf(const BagTopic& topic) {
  const std::string& name = topic.connection.topic;
  constexpr std::string_view kSuffix = "/compressed";
  return name.ends_with(kSuffix) ? name.substr(0, name.size() - kSuffix.size()) : name;
}

class Chooser {
 public:
  Chooser(const BagFile& bag, const TopicWish& wish, Diagnostics* diagnostics)
      : bag_(bag), wish_(wish), diagnostics_(diagnostics) {}

  TopicChoice run() {
    for (const auto& [sensor, name] : wish_.named) choice_[sensor] = findNamed(bag_, sensor, name);
    chooseCameras();
    for (const std::string& sensor : wish_.sensors) chooseSensor(sensor);
    reportUnused();
    return std::move(choice_);
  }

 private:
  bool isChosen(const BagTopic* topic) const {
    return std::any_of(choice_.begin(), choice_.end(),
                       [&](const auto& entry) { return entry.second == topic; });
  }

  void take(const std::string& sensor, const BagTopic* topic) {
    choice_[sensor] = topic;
    diagnostics_->report(Severity::Notice, "bag_topic",
                         fmt::format("{}: {} is taken from {}, found by its type", bag_.file().string(),
                                     sensor, topic->connection.topic));
  }

  void chooseCameras() {
    std::vector<std::string> missing;
    for (size_t i = 0; i < wish_.camera_count; ++i) {
      const std::string sensor = fmt::format("cam{}", i);
      if (!choice_.contains(sensor)) missing.push_back(sensor);
    }
    if (missing.empty()) return;
    std::vector<const BagTopic*> free = imageTopics(bag_);
    std::erase_if(free, [&](const BagTopic* topic) { return isChosen(topic); });
    if (free.size() != missing.size()) {
      throw InputError(
          fmt::format("{}: {} topics of images for {} cameras; name them with `topic` in the rig "
                      "file or --topic cam0=/…; {}",
                      bag_.file().string(), free.size(), missing.size(), listTopics(bag_)));
    }
    for (size_t i = 0; i < missing.size(); ++i) take(missing[i], free[i]);
  }

  void chooseSensor(const std::string& sensor) {
    if (choice_.contains(sensor)) return;
    const std::vector<const BagTopic*> found = topicsFor(bag_, sensor);
    if (found.empty()) return;
    if (found.size() > 1) {
      throw InputError(
          fmt::format("{}: {} topics could be {} ({}, {}, …); name one with `topic` in the rig file "
                      "or --topic {}=/…",
                      bag_.file().string(), found.size(), sensor, found[0]->connection.topic,
                      found[1]->connection.topic, sensor));
    }
    take(sensor, found.front());
  }

  void reportUnused() {
    for (const char* sensor : {"mag0", "pressure0", "sonar0"}) {
      if (choice_.contains(sensor)) continue;
      for (const BagTopic* topic : topicsFor(bag_, sensor)) {
        diagnostics_->report(
            Severity::Notice, "bag_topic_unused",
            fmt::format("{}: topic {} ({}) is not used: the rig file has no section {}", bag_.file().string(),
                        topic->connection.topic, topic->connection.type, sensor));
      }
    }
  }

  const BagFile& bag_;
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

TopicChoice chooseTopics(const BagFile& bag, const TopicWish& wish, Diagnostics* diagnostics) {
  return Chooser(bag, wish, diagnostics).run();
}

}  // namespace lodeline

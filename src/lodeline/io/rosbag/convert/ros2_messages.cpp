#include "lodeline/io/rosbag/convert/ros2_messages.h"

#include <fmt/core.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <limits>

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/definitions/definition_parser.h"
#include "lodeline/io/rosbag/definitions/known_definitions.h"

namespace lodeline {

std::string ros2TypeName(const std::string& type) {
  const size_t slash = type.find('/');
  if (slash == std::string::npos || type.find('/', slash + 1) != std::string::npos) return type;
  return fmt::format("{}/msg/{}", type.substr(0, slash), type.substr(slash + 1));
}

bool isStoredRos2(const BagConnection& connection) {
  return connection.serialization == definitions::Serialization::Cdr &&
         (!connection.definition.empty() ||
          definitions::knownFields(connection.type, definitions::Serialization::Cdr));
}

std::pair<WrittenTopic*, bool> Ros2Messages::topic(const std::string& name, const std::string& type,
                                                   const std::string& definition, Time received) {
  const int64_t seconds = received.nanoseconds() / 1'000'000'000;
  if (received.nanoseconds() < 0 || seconds > std::numeric_limits<int32_t>::max()) {
    throw InputError(
        fmt::format("a bag of ROS 2 cannot hold the stamp {} ns of topic {}: its times lie between 1970 and "
                    "2038",
                    received.nanoseconds(), name));
  }
  if (topics_.size() >= std::numeric_limits<uint16_t>::max()) throw InputError("too many topics for a bag");
  const bool is_first = messages() == 0;
  first_ = is_first ? received : std::min(first_, received);
  last_ = is_first ? received : std::max(last_, received);
  const auto [place, is_new] = topics_.try_emplace({name, type});
  WrittenTopic& topic = place->second;
  if (is_new) {
    topic = {static_cast<uint16_t>(topics_.size()), name, ros2TypeName(type),
             definition.empty() ? definitionOf(type) : definition, 0};
  }
  ++topic.messages;
  return {&topic, is_new};
}

const std::string& Ros2Messages::definitionOf(const std::string& type) {
  std::string& definition = definitions_[type];
  if (definition.empty()) definition = definitions::fullDefinition(type, definitions::Serialization::Cdr);
  return definition;
}

wire::Bytes Ros2Messages::toCdr(const std::string& type, const wire::Bytes& message) {
  auto& conversion = conversions_[type];
  if (conversion == nullptr) {
    conversion = std::make_unique<definitions::MessageConversion>(
        definitions::knownForm(type, definitions::Serialization::Ros1),
        definitions::knownForm(type, definitions::Serialization::Cdr));
  }
  return conversion->convert(message);
}

uint64_t Ros2Messages::messages() const {
  uint64_t messages = 0;
  for (const auto& [name, topic] : topics_) messages += topic.messages;
  return messages;
}

std::string metadataText(const Ros2Messages& messages, const std::string& file, const std::string& storage) {
  YAML::Node bag;
  const auto addSpan = [&](YAML::Node node) {
    node["duration"]["nanoseconds"] = (messages.last() - messages.first()).nanoseconds();
    node["starting_time"]["nanoseconds_since_epoch"] = messages.first().nanoseconds();
    node["message_count"] = messages.messages();
  };
  bag["version"] = 5;
  bag["storage_identifier"] = storage;
  addSpan(bag);
  for (const auto& [name, topic] : messages.topics()) {
    YAML::Node entry;
    entry["topic_metadata"]["name"] = topic.name;
    entry["topic_metadata"]["type"] = topic.type;
    entry["topic_metadata"]["serialization_format"] = "cdr";
    entry["topic_metadata"]["offered_qos_profiles"] = "";
    entry["message_count"] = topic.messages;
    bag["topics_with_message_count"].push_back(entry);
  }
  bag["compression_format"] = "";
  bag["compression_mode"] = "";
  bag["relative_file_paths"].push_back(file);
  YAML::Node part;
  part["path"] = file;
  addSpan(part);
  bag["files"].push_back(part);
  YAML::Node root;
  root["rosbag2_bagfile_information"] = bag;
  return YAML::Dump(root) + "\n";
}

}  // namespace lodeline

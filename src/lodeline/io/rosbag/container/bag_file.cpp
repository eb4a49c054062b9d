#include "lodeline/io/rosbag/container/bag_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <tuple>

#include "lodeline/io/rosbag/definitions/definition_parser.h"
#include "lodeline/io/rosbag/definitions/known_definitions.h"
#include "lodeline/io/rosbag/definitions/message_text.h"

namespace lodeline {
namespace {

using definitions::DefinitionError;
using definitions::MessageForm;
using definitions::Serialization;

/// The form of the messages, by the definition in the bag; where it has none or a damaged one, by the
/// built-in one.
MessageForm describe(const BagConnection& connection, Serialization serialization) {
  const bool is_known = definitions::knownFields(connection.type, serialization).has_value();
  if (connection.definition.empty() && !is_known) {
    throw DefinitionError(fmt::format("the bag has no definition of {}", connection.type));
  }
  const auto builtIn = [&] {
    return MessageForm{definitions::parseDefinition(connection.type, "", serialization), serialization, false,
                       definitions::hasVersions(connection.type)};
  };
  try {
    if (connection.definition.empty()) return builtIn();
    return {definitions::parseDefinition(connection.type, connection.definition, serialization),
            serialization};
  } catch (const DefinitionError& error) {
    if (is_known) return builtIn();
    throw DefinitionError(fmt::format("the definition of {} in the bag {}", connection.type, error.what()));
  }
}

/// Whether readers take the messages as they are stored: those of ROS 1, except where the definition in the
/// bag is another version of the one that Lodeline knows.
bool isReadAsStored(const BagConnection& connection) {
  if (*connection.serialization != Serialization::Ros1 || connection.md5sum.empty()) return false;
  return !definitions::hasVersions(connection.type) || connection.definition.empty() ||
         connection.md5sum == definitions::ros1Checksum(connection.type);
}

/// Finds how to convert the messages of a topic to the form that readers know.
void settleConversion(BagTopic* topic) {
  BagConnection& connection = topic->connection;
  if (!connection.serialization || isReadAsStored(connection)) return;
  try {
    MessageForm form = describe(connection, *connection.serialization);
    const std::string_view checksum = definitions::ros1Checksum(connection.type);
    if (checksum.empty()) return;
    topic->to_ros1 = std::make_shared<const definitions::MessageConversion>(
        std::move(form), definitions::knownForm(connection.type, Serialization::Ros1));
    if (!connection.md5sum.empty()) connection.other_md5sum = connection.md5sum;
    connection.md5sum = checksum;
  } catch (const DefinitionError& error) {
    connection.problem = error.what();
  }
}

bool isSame(const BagConnection& a, const BagConnection& b) {
  return a.topic == b.topic && a.type == b.type && a.md5sum == b.md5sum && a.serialization == b.serialization;
}

}  // namespace

void BagFile::setTopics(BagContents contents) {
  for (auto& [number, connection] : contents.connections) {
    std::vector<BagEntry>& entries = contents.entries[number];
    if (entries.empty()) continue;
    auto topic = std::find_if(
        topics_.begin(), topics_.end(),
        [&, &wanted = connection](const BagTopic& known) { return isSame(known.connection, wanted); });
    if (topic == topics_.end()) topic = topics_.insert(topics_.end(), {connection, {}, nullptr});
    topic->entries.insert(topic->entries.end(), entries.begin(), entries.end());
  }
  if (topics_.empty()) throw InputError(file().string() + ": holds no message that could be read");
  for (BagTopic& topic : topics_) {
    std::stable_sort(topic.entries.begin(), topic.entries.end(),
                     [](const BagEntry& a, const BagEntry& b) { return a.received < b.received; });
    settleConversion(&topic);
  }
  std::sort(topics_.begin(), topics_.end(), [](const BagTopic& a, const BagTopic& b) {
    return std::tie(a.connection.topic, a.connection.type) < std::tie(b.connection.topic, b.connection.type);
  });
}

std::optional<wire::Bytes> BagFile::read(const BagTopic& topic, const BagEntry& entry) {
  std::optional<wire::Bytes> message = stored(entry);
  if (!message || topic.to_ros1 == nullptr) return message;
  std::string problem;
  try {
    return topic.to_ros1->convert(*message);
  } catch (const wire::Reader::CutOff& error) {
    problem = error.what();
  } catch (const DefinitionError& error) {
    problem = error.what();
  }
  diagnostics_->report(Severity::Warning, "bag_message",
                       fmt::format("{} {}: the message received at {} ns: {}; passed over", file().string(),
                                   topic.connection.topic, entry.received.nanoseconds(), problem));
  return std::nullopt;
}

MessageLister::MessageLister(const BagTopic& topic, size_t most_elements)
    : problem_(topic.connection.problem), most_elements_(most_elements) {
  if (!problem_.empty() || !topic.connection.serialization) return;
  serialization_ = *topic.connection.serialization;
  try {
    type_ = describe(topic.connection, serialization_).type;
  } catch (const DefinitionError& error) {
    problem_ = error.what();
  }
}

std::string MessageLister::text(std::span<const uint8_t> stored) const {
  std::string problem = problem_;
  if (type_) {
    try {
      return definitions::messageText(stored, *type_, serialization_, most_elements_);
    } catch (const wire::Reader::CutOff& error) {
      problem = error.what();
    } catch (const DefinitionError& error) {
      problem = error.what();
    }
  }
  return fmt::format("{} bytes, not decoded: {}", stored.size(), problem);
}

}  // namespace lodeline

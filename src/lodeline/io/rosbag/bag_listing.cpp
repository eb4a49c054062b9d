#include "lodeline/io/rosbag/bag_listing.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "lodeline/io/rosbag/messages.h"
#include "lodeline/sensors/sensor_kind.h"

namespace lodeline {
namespace {

/// Sensors that may take their readings from a topic.
std::string useOf(const BagConnection& connection) {
  if (!connection.problem.empty()) return "not decoded: " + connection.problem;
  const auto fits = [&](const std::string& sensor) {
    const std::vector<messages::Type> types = messages::namedTypesOf(sensor);
    return std::any_of(types.begin(), types.end(), [&](const messages::Type& type) {
      return connection.type == type.name && connection.md5sum == type.md5sum;
    });
  };
  for (const std::string sensor : kSingleSensors) {
    if (fits(sensor)) return "for " + sensor;
  }
  return fits("cam0") ? "for cameras" : "no sensor takes its type";
}

}  // namespace

std::string topicsText(const BagFile& bag) {
  std::string text = "topics:\n";
  for (const BagTopic& topic : bag.topics()) {
    text += fmt::format("  {:<36} {:<36} {:>8}  {}\n", topic.connection.topic, topic.connection.type,
                        topic.entries.size(), useOf(topic.connection));
  }
  return text;
}

void listMessages(BagFile* bag, size_t most_elements, std::ostream* stream) {
  const std::vector<BagTopic>& topics = bag->topics();
  std::vector<MessageLister> listers;
  for (const BagTopic& topic : topics) listers.emplace_back(topic, most_elements);
  std::vector<size_t> next(topics.size(), 0);
  while (true) {
    std::optional<size_t> first;
    for (size_t i = 0; i < topics.size(); ++i) {
      if (next[i] == topics[i].entries.size()) continue;
      const Time received = topics[i].entries[next[i]].received;
      if (!first || received < topics[*first].entries[next[*first]].received) first = i;
    }
    if (!first) return;
    const BagEntry& entry = topics[*first].entries[next[*first]++];
    const std::optional<wire::Bytes> message = bag->stored(entry);
    *stream << fmt::format("{} {} {} {}\n", entry.received.nanoseconds(), topics[*first].connection.topic,
                           topics[*first].connection.type,
                           message ? listers[*first].text(*message) : "damaged");
  }
}

}  // namespace lodeline

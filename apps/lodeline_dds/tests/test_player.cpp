#include "apps/lodeline_dds/tests/test_player.h"

#include <algorithm>
#include <thread>

#include "lodeline/io/rosbag/bag_kinds.h"
#include "lodeline/io/rosbag/definitions/field_reader.h"
#include "lodeline/io/rosbag/topic_choice.h"

namespace lodeline::test {
namespace {

constexpr const char* kPoses = "/lodeline/odometry";
constexpr int kDeep = 5000;

}  // namespace

Time stampOfCdr(const std::vector<uint8_t>& cdr) {
  definitions::FieldReader reader(cdr, definitions::Serialization::Cdr);
  const int64_t seconds = reader.number<int32_t>();
  return Time::fromNanoseconds(seconds * 1'000'000'000 + reader.number<uint32_t>());
}

std::vector<std::string> imageTopicsOf(const std::filesystem::path& bag) {
  Diagnostics diagnostics;
  const auto file = openBagFile(bag, &diagnostics);
  std::vector<std::string> topics;
  for (const BagTopic* topic : imageTopics(*file)) topics.push_back(topic->connection.topic);
  return topics;
}

TestPlayer::TestPlayer(const std::filesystem::path& bag, const dds::NetworkOptions& network, bool is_reliable,
                       const std::vector<std::string>& topics)
    : bag_(openBagFile(bag, &diagnostics_)), network_(network) {
  for (const BagTopic& topic : bag_->topics()) {
    const std::string& name = topic.connection.topic;
    if (!topics.empty() && std::find(topics.begin(), topics.end(), name) == topics.end()) continue;
    writers_[name] = network_.advertise(name, topic.connection.type, {is_reliable, kDeep, false});
    for (const BagEntry& entry : topic.entries) {
      messages_.push_back({entry.received, name, &topic, entry, writers_[name]});
    }
  }
  std::stable_sort(messages_.begin(), messages_.end(),
                   [](const Message& a, const Message& b) { return a.received < b.received; });
}

bool TestPlayer::waitForSubscribers(double timeout_s) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
  const auto isHeard = [this](const auto& writer) { return network_.subscribers(writer.second) > 0; };
  while (!std::all_of(writers_.begin(), writers_.end(), isHeard)) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

void TestPlayer::publish(const Message& message) {
  network_.publish(message.writer, bag_->stored(message.entry).value());
}

void TestPlayer::publishBytes(const std::string& topic, std::vector<uint8_t> cdr) {
  network_.publish(writers_.at(topic), std::move(cdr));
}

void TestPlayer::hear(const std::string& topic, const std::string& type) {
  network_.subscribe(topic, type, {true, kDeep, false}, [this, topic](std::vector<uint8_t> cdr, uint64_t) {
    const std::lock_guard lock(mutex_);
    heard_[topic].push_back({std::move(cdr), std::chrono::steady_clock::now()});
    changed_.notify_all();
  });
}

std::vector<TestPlayer::Heard> TestPlayer::heard(const std::string& topic) const {
  const std::lock_guard lock(mutex_);
  const auto place = heard_.find(topic);
  return place == heard_.end() ? std::vector<Heard>() : place->second;
}

size_t TestPlayer::countOf(const std::string& topic) const {
  const std::lock_guard lock(mutex_);
  const auto place = heard_.find(topic);
  return place == heard_.end() ? 0 : place->second.size();
}

bool TestPlayer::waitFor(const std::string& topic, size_t messages, double timeout_s) const {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, std::chrono::duration<double>(timeout_s), [&] {
    const auto place = heard_.find(topic);
    return place != heard_.end() && place->second.size() >= messages;
  });
}

std::optional<Time> TestPlayer::poseTime() const {
  const std::lock_guard lock(mutex_);
  const auto place = heard_.find(kPoses);
  if (place == heard_.end() || place->second.empty()) return std::nullopt;
  return stampOfCdr(place->second.back().cdr);
}

}  // namespace lodeline::test

#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "apps/lodeline_dds/transport/dds_network.h"
#include "lodeline/io/rosbag/container/bag_file.h"

namespace lodeline::test {

/// Publishes the messages of a ROS 2 bag over DDS, and hears what lodeline_dds publishes.
class TestPlayer {
 public:
  struct Heard {
    std::vector<uint8_t> cdr;
    std::chrono::steady_clock::time_point arrival;
  };

  /// `topics`: names of the topics to play; empty for all.
  TestPlayer(const std::filesystem::path& bag, const dds::NetworkOptions& network, bool is_reliable,
             const std::vector<std::string>& topics = {});

  /// Waits until every topic has a subscriber.
  bool waitForSubscribers(double timeout_s);

  struct Message {
    Time received;  ///< when it was recorded
    std::string topic;
    const BagTopic* source = nullptr;
    BagEntry entry;
    size_t writer = 0;
  };
  /// In the order of their recording.
  const std::vector<Message>& messages() const { return messages_; }
  void publish(const Message& message);
  /// Publishes unchanged bytes on a topic of the bag.
  void publishBytes(const std::string& topic, std::vector<uint8_t> cdr);

  /// Starts to keep the messages of a topic.
  void hear(const std::string& topic, const std::string& type);
  /// Messages of a topic so far.
  std::vector<Heard> heard(const std::string& topic) const;
  size_t countOf(const std::string& topic) const;
  /// Waits until a topic has so many messages.
  bool waitFor(const std::string& topic, size_t messages, double timeout_s) const;
  /// Stamp of the last odometry message; nothing where there is none.
  std::optional<Time> poseTime() const;

 private:
  Diagnostics diagnostics_;
  std::unique_ptr<BagFile> bag_;
  std::vector<Message> messages_;
  std::map<std::string, size_t> writers_;
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::map<std::string, std::vector<Heard>> heard_;
  dds::Network network_;  ///< last, because its threads use what stands above
};

/// Topics of images of a bag, in the order of their names.
std::vector<std::string> imageTopicsOf(const std::filesystem::path& bag);

/// The stamp with which a message of ROS 2 begins.
Time stampOfCdr(const std::vector<uint8_t>& cdr);

}  // namespace lodeline::test

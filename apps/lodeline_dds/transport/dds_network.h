#pragma once

#include <cstdint>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace lodeline::dds {

struct NetworkOptions {
  int domain = 0;
  /// Whether other machines are reached. Otherwise all sockets are bound to the loopback interface.
  bool all_interfaces = false;
};

/// Quality of service of a topic, in the terms of ROS 2. History is always keep last.
struct TopicQos {
  bool is_reliable = false;
  int depth = 5;
  bool is_latched = false;  ///< transient local: subscribers that come later get the last messages
};

/// Takes part in a DDS domain like a node of ROS 2 with rmw_fastrtps. Throws std::runtime_error where the
/// network cannot be used.
class Network : private eprosima::fastdds::dds::DomainParticipantListener {
 public:
  /// A message with the number of those before it that were lost on the way from the same publisher.
  using OnMessage = std::function<void(std::vector<uint8_t> cdr, uint64_t lost)>;
  /// A publisher was found: names as DDS has them. Called from a thread of DDS; it must not use the network.
  using OnPublisher = std::function<void(const std::string& dds_topic, const std::string& dds_type)>;

  explicit Network(const NetworkOptions& options, OnPublisher on_publisher = {});
  ~Network() override;
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;

  /// Starts to receive; `on_message` is called from threads of DDS. `type`: as in ROS, "sensor_msgs/Imu".
  void subscribe(const std::string& full_name, const std::string& type, const TopicQos& qos,
                 OnMessage on_message);
  /// Returns the place of a new writer.
  size_t advertise(const std::string& full_name, const std::string& type, const TopicQos& qos);
  /// Hands a message over to the thread that sends; does not wait for subscribers.
  void publish(size_t writer, std::vector<uint8_t> cdr);
  /// Number of matched subscribers of a writer.
  int subscribers(size_t writer) const;

  /// Stops receiving. Messages that were published are sent first, in `patience_s` at most.
  void close(double patience_s = 1.0);

 private:
  class Receiver;

  void on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;
  eprosima::fastdds::dds::Topic* topicOf(const std::string& full_name, const std::string& type);

  OnPublisher on_publisher_;
  bool is_closed_ = false;
  eprosima::fastdds::dds::DomainParticipant* participant_ = nullptr;
  eprosima::fastdds::dds::Publisher* publisher_ = nullptr;
  eprosima::fastdds::dds::Subscriber* subscriber_ = nullptr;
  std::map<std::string, eprosima::fastdds::dds::Topic*> topics_;
  std::vector<eprosima::fastdds::dds::DataWriter*> writers_;
  std::vector<std::unique_ptr<Receiver>> receivers_;
};

}  // namespace lodeline::dds

#include "apps/lodeline_dds/transport/dds_network.h"

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <algorithm>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <stdexcept>
#include <utility>

#include "apps/lodeline_dds/transport/dds_names.h"
#include "apps/lodeline_dds/transport/raw_type.h"

namespace lodeline::dds {
namespace {

namespace edds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

constexpr const char* kLoopback = "127.0.0.1";
/// Participants of the machine that are looked for by unicast, as ROS 2 does for its range LOCALHOST.
/// Loopback interfaces need not have multicast.
constexpr uint32_t kParticipants = 32;
/// Shared memory for messages that were published and not yet taken; several images.
constexpr uint32_t kSharedBytes = 8 << 20;

/// Restricts all sockets to the loopback interface, as ROS_LOCALHOST_ONLY=1 does with rmw_fastrtps.
void restrictToLoopback(edds::DomainParticipantQos* qos) {
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = {kLoopback};
  udp->maxInitialPeersRange = kParticipants;
  qos->transport().use_builtin_transports = false;
  auto memory = std::make_shared<eprosima::fastdds::rtps::SharedMemTransportDescriptor>();
  memory->segment_size(kSharedBytes);
  qos->transport().user_transports = {memory, udp};
  rtps::LocatorList_t& peers = qos->wire_protocol().builtin.initialPeersList;
  for (const char* address : {kLoopback, "239.255.0.1"}) {  // the second is that of RTPS for discovery
    rtps::Locator_t peer(LOCATOR_KIND_UDPv4, 0);
    rtps::IPLocator::setIPv4(peer, address);
    peers.push_back(peer);
  }
}

/// Sets what readers and writers have in common.
template <typename Qos>
void apply(const TopicQos& wanted, Qos* qos) {
  qos->reliability().kind =
      wanted.is_reliable ? edds::RELIABLE_RELIABILITY_QOS : edds::BEST_EFFORT_RELIABILITY_QOS;
  qos->durability().kind =
      wanted.is_latched ? edds::TRANSIENT_LOCAL_DURABILITY_QOS : edds::VOLATILE_DURABILITY_QOS;
  qos->history().kind = edds::KEEP_LAST_HISTORY_QOS;
  qos->history().depth = wanted.depth;
  qos->resource_limits().max_instances = 1;
  qos->resource_limits().max_samples = wanted.depth;
  qos->resource_limits().max_samples_per_instance = wanted.depth;
  qos->resource_limits().allocated_samples = std::min(wanted.depth, 10);
  qos->endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos->data_sharing().off();  // as rmw_fastrtps has it
}

template <typename Made>
Made* required(Made* made, const std::string& what) {
  if (made == nullptr) throw std::runtime_error("DDS refuses " + what);
  return made;
}

}  // namespace

/// Takes the messages of a reader.
class Network::Receiver : public edds::DataReaderListener {
 public:
  explicit Receiver(OnMessage on_message) : on_message_(std::move(on_message)) {}

  void on_data_available(edds::DataReader* reader) override {
    const std::lock_guard lock(mutex_);
    RawSample sample;
    edds::SampleInfo info;
    while (reader->take_next_sample(&sample, &info) == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      const uint64_t lost = lostBefore(info);
      on_message_(std::move(sample.cdr), lost);
      sample.cdr.clear();
    }
  }

 private:
  /// Publishers number their messages. A gap is a message that was lost on the way or overwritten in a queue.
  uint64_t lostBefore(const edds::SampleInfo& info) {
    const uint64_t number = info.sample_identity.sequence_number().to64long();
    const auto [place, is_new] = last_.try_emplace(info.sample_identity.writer_guid(), number);
    const uint64_t lost = is_new || number <= place->second ? 0 : number - place->second - 1;
    place->second = std::max(place->second, number);
    return lost;
  }

  OnMessage on_message_;
  std::mutex mutex_;
  std::map<rtps::GUID_t, uint64_t> last_;  ///< number of the last message, by publisher
};

Network::Network(const NetworkOptions& options, OnPublisher on_publisher)
    : on_publisher_(std::move(on_publisher)) {
  edds::DomainParticipantQos qos = edds::PARTICIPANT_QOS_DEFAULT;
  qos.name("lodeline");
  if (!options.all_interfaces) restrictToLoopback(&qos);
  participant_ = required(edds::DomainParticipantFactory::get_instance()->create_participant(
                              static_cast<uint32_t>(options.domain), qos, this, edds::StatusMask::none()),
                          "to take part in domain " + std::to_string(options.domain));
  publisher_ = required(participant_->create_publisher(edds::PUBLISHER_QOS_DEFAULT), "a publisher");
  subscriber_ = required(participant_->create_subscriber(edds::SUBSCRIBER_QOS_DEFAULT), "a subscriber");
}

Network::~Network() {
  close();
  participant_->set_listener(nullptr);
  participant_->delete_contained_entities();
  edds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
}

void Network::on_publisher_discovery(edds::DomainParticipant*, rtps::WriterDiscoveryInfo&& info) {
  if (info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER || !on_publisher_) return;
  on_publisher_(info.info.topicName().to_string(), info.info.typeName().to_string());
}

edds::Topic* Network::topicOf(const std::string& full_name, const std::string& type) {
  edds::Topic*& topic = topics_[full_name];
  if (topic != nullptr) return topic;
  const std::string dds_type = ddsType(type);
  edds::TypeSupport(new RawType(dds_type)).register_type(participant_);
  topic = required(participant_->create_topic(ddsTopic(full_name), dds_type, edds::TOPIC_QOS_DEFAULT),
                   "topic " + full_name + " of type " + type);
  return topic;
}

void Network::subscribe(const std::string& full_name, const std::string& type, const TopicQos& wanted,
                        OnMessage on_message) {
  edds::DataReaderQos qos = edds::DATAREADER_QOS_DEFAULT;
  apply(wanted, &qos);
  Receiver* receiver = receivers_.emplace_back(std::make_unique<Receiver>(std::move(on_message))).get();
  required(subscriber_->create_datareader(topicOf(full_name, type), qos, receiver,
                                          edds::StatusMask::data_available()),
           "a reader of " + full_name);
}

size_t Network::advertise(const std::string& full_name, const std::string& type, const TopicQos& wanted) {
  edds::DataWriterQos qos = edds::DATAWRITER_QOS_DEFAULT;
  apply(wanted, &qos);
  qos.publish_mode().kind = edds::ASYNCHRONOUS_PUBLISH_MODE;
  writers_.push_back(
      required(publisher_->create_datawriter(topicOf(full_name, type), qos), "a writer of " + full_name));
  return writers_.size() - 1;
}

void Network::publish(size_t writer, std::vector<uint8_t> cdr) {
  RawSample sample{std::move(cdr)};
  writers_.at(writer)->write(&sample);
}

int Network::subscribers(size_t writer) const {
  edds::PublicationMatchedStatus status;
  writers_.at(writer)->get_publication_matched_status(status);
  return status.current_count;
}

void Network::close(double patience_s) {
  std::vector<edds::DataReader*> readers;
  subscriber_->get_datareaders(readers);
  for (edds::DataReader* reader : readers) {
    reader->set_listener(nullptr);
    subscriber_->delete_datareader(reader);
  }
  receivers_.clear();
  if (std::exchange(is_closed_, true)) return;
  const eprosima::fastrtps::Duration_t patience(static_cast<long double>(patience_s));
  publisher_->wait_for_acknowledgments(patience);
}

}  // namespace lodeline::dds

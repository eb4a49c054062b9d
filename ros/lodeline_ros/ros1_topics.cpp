#include "lodeline_ros/ros1_topics.h"

#include <boost/make_shared.hpp>
#include <stdexcept>

#include "lodeline_ros/message_types.h"
#include "lodeline_ros/raw_message.h"

namespace lodeline {
namespace {

using Event = ros::MessageEvent<const RawMessage>;

std::string header(const Event& event, const char* field) {
  const auto found = event.getConnectionHeader().find(field);
  return found == event.getConnectionHeader().end() ? std::string() : found->second;
}

/// Sets checksum and definition of the type, as ROS 1's own headers have them.
template <typename... Messages>
bool describe(const std::string& type, ros::AdvertiseOptions* options) {
  const auto describeOne = [&]<typename Message>(const Message*) {
    if (type != ros::message_traits::DataType<Message>::value()) return false;
    options->md5sum = ros::message_traits::MD5Sum<Message>::value();
    options->message_definition = ros::message_traits::Definition<Message>::value();
    return true;
  };
  return (describeOne(static_cast<const Messages*>(nullptr)) || ...);
}

}  // namespace

Ros1Topics::Ros1Topics(ros::NodeHandle node, ros::NodeHandle private_node, RosSession* session)
    : session_(session) {
  for (const auto& publication : session->publications()) advertise(publication, &private_node);
  for (size_t i = 0; i < session->subscriptions().size(); ++i) subscribe(i, &node);
}

void Ros1Topics::subscribe(size_t place, ros::NodeHandle* node) {
  const RosSession::Subscription& subscription = session_->subscriptions()[place];
  const boost::function<void(const Event&)> callback = [session = session_, place](const Event& event) {
    session->receive(place, header(event, "type"), event.getMessage()->bytes, header(event, "md5sum"));
  };
  constexpr const char* kAny = "*";
  ros::SubscribeOptions options(subscription.topic, static_cast<uint32_t>(subscription.depth), kAny, kAny);
  options.helper = boost::make_shared<ros::SubscriptionCallbackHelperT<const Event&>>(callback);
  options.transport_hints = ros::TransportHints().tcpNoDelay();
  subscribers_.push_back(node->subscribe(options));
}

void Ros1Topics::advertise(const RosSession::Publication& publication, ros::NodeHandle* node) {
  ros::AdvertiseOptions options(publication.topic, static_cast<uint32_t>(publication.depth), "",
                                publication.type, "");
  if (!describe<message::Odometry, message::PoseStamped, message::PoseWithCovarianceStamped, message::Path,
                message::PointCloud2, message::DiagnosticArray, message::TFMessage>(publication.type,
                                                                                    &options)) {
    throw std::logic_error("no definition of " + publication.type);
  }
  options.latch = publication.is_latched;
  publishers_.push_back(node->advertise(options));
}

void Ros1Topics::publish(size_t publication, RosSession::Bytes message) const {
  publishers_.at(publication).publish(RawMessage{std::move(message)});
}

}  // namespace lodeline

#include "lodeline_ros2/lodeline_component.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <rclcpp_components/register_node_macro.hpp>
#include <stdexcept>

#include "lodeline_ros2/parameters.h"

namespace lodeline {
namespace {

/// "sensor_msgs/msg/Imu" for "sensor_msgs/Imu".
std::string ros2Type(const std::string& type) {
  const size_t slash = type.find('/');
  return type.substr(0, slash) + "/msg" + type.substr(slash);
}

rclcpp::QoS sensorQos(const RosSession::Subscription& subscription) {
  rclcpp::QoS qos = rclcpp::SensorDataQoS();
  qos.keep_last(static_cast<size_t>(subscription.depth));
  if (subscription.is_reliable) qos.reliable();
  return qos;
}

rclcpp::QoS resultQos(const RosSession::Publication& publication) {
  rclcpp::QoS qos(static_cast<size_t>(publication.depth));
  qos.reliable();
  if (publication.is_latched) qos.transient_local();
  return qos;
}

RosSession::Bytes bytesOf(const rclcpp::SerializedMessage& message) {
  const rcl_serialized_message_t& raw = message.get_rcl_serialized_message();
  return {raw.buffer, raw.buffer + raw.buffer_length};
}

rclcpp::SerializedMessage serialized(const RosSession::Bytes& bytes) {
  rclcpp::SerializedMessage message(bytes.size());
  rcl_serialized_message_t& raw = message.get_rcl_serialized_message();
  std::memcpy(raw.buffer, bytes.data(), bytes.size());
  raw.buffer_length = bytes.size();
  return message;
}

}  // namespace

LodelineComponent::LodelineComponent(const rclcpp::NodeOptions& options)
    : Node("lodeline", options),
      session_(std::make_unique<RosSession>(readParameters(this), RosSession::Encoding::Cdr)) {
  for (const RosSession::Subscription& subscription : session_->subscriptions()) {
    sensor_topics_.push_back(get_node_topics_interface()->resolve_topic_name(subscription.topic));
  }
  advertise();
  RCLCPP_INFO(get_logger(), "%s", session_->description().c_str());
  using namespace std::chrono_literals;
  search_timer_ = create_wall_timer(200ms, [this] { lookForPublishers(); });
  diagnostics_timer_ = create_wall_timer(1s, [this] {
    session_->publishDiagnostics(
        now().nanoseconds(),
        [this](size_t publication, const RosSession::Bytes& message) { publish(publication, message); });
  });
  estimator_ = std::thread([this] { estimate(); });
}

LodelineComponent::~LodelineComponent() {
  search_timer_->cancel();
  diagnostics_timer_->cancel();
  session_->close();
  if (estimator_.joinable()) estimator_.join();
  try {
    RCLCPP_INFO(get_logger(), "\n%s", session_->finish().c_str());
  } catch (const std::exception& error) {
    RCLCPP_ERROR(get_logger(), "the files could not be completed: %s", error.what());
  }
}

void LodelineComponent::advertise() {
  for (const RosSession::Publication& publication : session_->publications()) {
    const bool is_absolute = publication.topic.front() == '/';
    const std::string topic = is_absolute ? publication.topic : "~/" + publication.topic;
    publishers_.push_back(
        create_generic_publisher(topic, ros2Type(publication.type), resultQos(publication)));
  }
}

void LodelineComponent::lookForPublishers() {
  const auto found = get_topic_names_and_types();
  for (size_t i = 0; i < sensor_topics_.size(); ++i) {
    const auto topic = found.find(sensor_topics_[i]);
    if (subscribed_.count(i) > 0 || topic == found.end() || count_publishers(topic->first) == 0) continue;
    const RosSession::Subscription& subscription = session_->subscriptions()[i];
    const auto type =
        std::find_if(subscription.types.begin(), subscription.types.end(), [&](const std::string& own) {
          return std::find(topic->second.begin(), topic->second.end(), ros2Type(own)) != topic->second.end();
        });
    const auto refuse = [&](const std::string& problem) {
      if (!refused_.insert(topic->first).second) return;
      RCLCPP_WARN(get_logger(), "%s %s", topic->first.c_str(), problem.c_str());
      session_->addProblem(i, problem);
    };
    if (type == subscription.types.end()) {
      refuse("is of type " + topic->second.front() + ", which " + subscription.sensor + " does not have");
      continue;
    }
    try {
      subscribe(i, *type);
    } catch (const std::exception& error) {  // the package of a driver's messages is not installed
      refuse(std::string("cannot be subscribed: ") + error.what());
    }
  }
  if (subscribed_.size() == sensor_topics_.size()) search_timer_->cancel();
}

void LodelineComponent::subscribe(size_t place, const std::string& type) {
  rclcpp::SubscriptionOptions options;
  options.event_callbacks.message_lost_callback = [this, place](rclcpp::QOSMessageLostInfo& info) {
    session_->addLost(place, info.total_count_change);
  };
  const auto receive = [this, place, type](std::shared_ptr<const rclcpp::SerializedMessage> message) {
    session_->receive(place, type, bytesOf(*message));
  };
  const auto create = [&] {
    return create_generic_subscription(sensor_topics_[place], ros2Type(type),
                                       sensorQos(session_->subscriptions()[place]), receive, options);
  };
  try {
    subscriptions_.push_back(create());
  } catch (const rclcpp::UnsupportedEventTypeException&) {  // this middleware counts no lost messages
    options.event_callbacks.message_lost_callback = nullptr;
    subscriptions_.push_back(create());
  }
  subscribed_.insert(place);
}

void LodelineComponent::publish(size_t publication, const RosSession::Bytes& message) {
  // The container may have ended ROS while images that wait are still worked off.
  if (!rclcpp::ok(get_node_base_interface()->get_context())) return;
  try {
    publishers_.at(publication)->publish(serialized(message));
  } catch (const std::runtime_error& error) {
    RCLCPP_WARN_ONCE(get_logger(), "a message could not be published: %s", error.what());
  }
}

void LodelineComponent::estimate() {
  try {
    session_->run(
        [this](size_t publication, const RosSession::Bytes& message) { publish(publication, message); });
  } catch (const std::exception& error) {
    RCLCPP_FATAL(get_logger(), "%s", error.what());
  }
}

}  // namespace lodeline

RCLCPP_COMPONENTS_REGISTER_NODE(lodeline::LodelineComponent)

#pragma once

#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "lodeline/node/ros_session.h"

namespace lodeline {

/// The estimator as a composable node of ROS 2 (docs/reference/ros2-node.md). The session does the work, on a
/// thread of its own; the node only moves messages as bytes. A sensor's topic is subscribed to when it has a
/// publisher, whose type decides which of the sensor's types it is.
class LodelineComponent : public rclcpp::Node {
 public:
  explicit LodelineComponent(const rclcpp::NodeOptions& options);
  ~LodelineComponent() override;

 private:
  void advertise();
  void lookForPublishers();
  void subscribe(size_t place, const std::string& type);
  void publish(size_t publication, const RosSession::Bytes& message);
  void estimate();

  std::unique_ptr<RosSession> session_;
  std::vector<std::string> sensor_topics_;  ///< full names, by subscription
  std::set<size_t> subscribed_;
  std::set<std::string> refused_;  ///< topics with types that their sensors do not have
  std::vector<rclcpp::GenericPublisher::SharedPtr> publishers_;
  std::vector<rclcpp::GenericSubscription::SharedPtr> subscriptions_;
  rclcpp::TimerBase::SharedPtr search_timer_, diagnostics_timer_;
  std::thread estimator_;
};

}  // namespace lodeline

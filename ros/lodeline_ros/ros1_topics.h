#pragma once

#include <ros/node_handle.h>

#include <vector>

#include "lodeline/node/ros_session.h"

namespace lodeline {

/// The topics of a session as topics of ROS 1. Subscribers accept messages of any type as bytes.
class Ros1Topics {
 public:
  /// `node`: handle of the node's public namespace, `private_node`: of the private one, in which results are
  /// published. `session` must outlive this.
  Ros1Topics(ros::NodeHandle node, ros::NodeHandle private_node, RosSession* session);

  /// Publishes a message on one of the session's topics.
  void publish(size_t publication, RosSession::Bytes message) const;

 private:
  void subscribe(size_t place, ros::NodeHandle* node);
  void advertise(const RosSession::Publication& publication, ros::NodeHandle* node);

  RosSession* session_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::Publisher> publishers_;
};

}  // namespace lodeline

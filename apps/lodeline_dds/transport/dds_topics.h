#pragma once

#include <condition_variable>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "apps/lodeline_dds/transport/dds_network.h"
#include "lodeline/node/ros_session.h"

namespace lodeline::dds {

/// The topics of a session as topics of ROS 2. Which of its types a sensor's topic has is known when a
/// publisher is found; only then the session subscribes to it. Publishes the diagnostics once per second.
class Topics {
 public:
  /// `name_space`: that of the results. `session` must outlive this.
  Topics(const NetworkOptions& options, const std::string& name_space, RosSession* session);
  ~Topics();
  Topics(const Topics&) = delete;
  Topics& operator=(const Topics&) = delete;

  void publish(size_t publication, RosSession::Bytes message);
  /// Stops receiving, and waits a moment for messages that are still on their way to subscribers.
  void close();

 private:
  using Found = std::pair<std::string, std::string>;  ///< topic and type as DDS has them

  void work();
  void subscribe(const Found& found);

  RosSession* session_;
  std::vector<std::string> names_;  ///< of the subscriptions
  std::set<size_t> subscribed_;
  std::set<Found> seen_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Found> found_;
  bool over_ = false;
  Network network_;
  std::thread worker_;
};

}  // namespace lodeline::dds

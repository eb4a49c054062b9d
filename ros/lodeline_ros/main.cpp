// lodeline_ros: the estimator as a ROS 1 node (docs/reference/ros-node.md).

#include <fmt/core.h>
#include <ros/ros.h>

#include "lodeline/diagnostics.h"
#include "lodeline/node/node_main.h"
#include "lodeline_ros/node_parameters.h"
#include "lodeline_ros/ros1_topics.h"

namespace lodeline {
namespace {

void runNode() {
  if (!ros::master::check()) {
    throw UsageError(fmt::format("no ROS master answers at {}; start roscore", ros::master::getURI()));
  }
  ros::NodeHandle node;
  ros::NodeHandle private_node("~");
  RosSession session(readNodeParameters(private_node), RosSession::Encoding::Ros1);
  const Ros1Topics topics(node, private_node, &session);
  const RosSession::Publish publish = [&topics](size_t publication, RosSession::Bytes message) {
    topics.publish(publication, std::move(message));
  };
  const EndWatch watch(&session, [] { return !ros::ok(); });
  const ros::WallTimer timer = node.createWallTimer(ros::WallDuration(1.0), [&](const ros::WallTimerEvent&) {
    session.publishDiagnostics(static_cast<int64_t>(ros::Time::now().toNSec()), publish);
  });
  ros::AsyncSpinner spinner(1);
  spinner.start();
  ROS_INFO("%s", session.description().c_str());
  session.run(publish);
  spinner.stop();
  fmt::print("{}", session.finish());
}

}  // namespace
}  // namespace lodeline

int main(int argc, char** argv) {
  ros::init(argc, argv, "lodeline", ros::init_options::NoSigintHandler);
  return lodeline::runNodeMain(argv[0], lodeline::runNode);
}

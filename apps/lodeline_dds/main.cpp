// lodeline_dds: the estimator in a network of ROS 2, without ROS 2 (docs/reference/ros2-node.md).

#include <fmt/core.h>

#include <cstdio>

#include "apps/lodeline_dds/dds_options.h"
#include "apps/lodeline_dds/transport/dds_topics.h"
#include "lodeline/node/node_main.h"

namespace {

void run(const lodeline::dds::Options& options) {
  using lodeline::RosSession;
  RosSession session(options.session, RosSession::Encoding::Cdr);
  lodeline::dds::Topics topics(options.network, options.name_space, &session);
  const lodeline::EndWatch watch(&session, [] { return false; });
  fmt::print(stderr, "{} in domain {}, {}\n", session.description(), options.network.domain,
             options.network.all_interfaces ? "on all interfaces" : "on this machine alone");
  session.run([&topics](size_t publication, RosSession::Bytes message) {
    topics.publish(publication, std::move(message));
  });
  topics.close();
  fmt::print("{}", session.finish());
}

}  // namespace

int main(int argc, char** argv) {
  return lodeline::runNodeMain(argv[0], [&] {
    if (const auto options = lodeline::dds::readOptions(argc, argv)) run(*options);
  });
}

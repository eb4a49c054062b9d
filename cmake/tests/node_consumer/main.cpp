#include <lodeline/node/ros_session.h>

#include <stdexcept>

// A session without a rig says so.
int main() {
  try {
    lodeline::RosSession session({}, lodeline::RosSession::Encoding::Cdr);
  } catch (const std::exception& error) {
    return std::string(error.what()).find("rig") == std::string::npos ? 1 : 0;
  }
  return 1;
}

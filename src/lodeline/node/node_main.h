#pragma once

#include <atomic>
#include <functional>
#include <thread>

#include "lodeline/node/ros_session.h"
#include "lodeline/pipeline/stop_request.h"

namespace lodeline {

/// Runs the body of a program that is a node, with the log and the threads of `lodeline run`. Returns the
/// exit code of docs/reference/exit-codes.md; the end by Ctrl-C is a good one.
int runNodeMain(const char* program, const std::function<void()>& body);

/// Closes a session when the user or the transport ends the node.
class EndWatch {
 public:
  /// `is_over`: whether the transport has ended; called from another thread.
  EndWatch(RosSession* session, std::function<bool()> is_over);
  ~EndWatch();
  EndWatch(const EndWatch&) = delete;
  EndWatch& operator=(const EndWatch&) = delete;

 private:
  StopRequest stop_;
  std::atomic<bool> over_ = false;
  std::thread thread_;
};

}  // namespace lodeline

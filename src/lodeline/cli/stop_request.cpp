#include "lodeline/cli/stop_request.h"

#include <csignal>

namespace lodeline {
namespace {

volatile std::sig_atomic_t stop_requested = 0;

void requestStop(int signal) {
  stop_requested = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

StopRequest::StopRequest() {
  stop_requested = 0;
  std::signal(SIGINT, requestStop);
  std::signal(SIGTERM, requestStop);
}

StopRequest::~StopRequest() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

bool StopRequest::made() const { return stop_requested != 0; }

}  // namespace lodeline

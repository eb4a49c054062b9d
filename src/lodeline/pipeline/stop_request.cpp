#include "lodeline/pipeline/stop_request.h"

#include <csignal>

namespace lodeline {
namespace {

/// Ctrl-C, a normal kill, and a closed terminal.
constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

volatile std::sig_atomic_t stop_requested = 0;

void requestStop(int signal) {
  stop_requested = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

StopRequest::StopRequest() {
  stop_requested = 0;
  // A signal that the caller ignores (nohup) stays ignored.
  for (const int signal : kSignals) {
    if (std::signal(signal, requestStop) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
}

StopRequest::~StopRequest() {
  for (const int signal : kSignals) {
    if (std::signal(signal, SIG_DFL) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
}

bool StopRequest::made() const { return stop_requested != 0; }

}  // namespace lodeline

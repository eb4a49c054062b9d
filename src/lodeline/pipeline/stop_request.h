#pragma once

namespace lodeline {

/// Signal handler for a clean stop: while one exists, the first Ctrl-C (SIGINT), SIGTERM or SIGHUP requests a
/// stop instead of ending the program, so that results can be completed. The second one ends it as usual.
/// Only one may exist at a time.
class StopRequest {
 public:
  StopRequest();
  ~StopRequest();
  StopRequest(const StopRequest&) = delete;
  StopRequest& operator=(const StopRequest&) = delete;

  bool made() const;
};

}  // namespace lodeline

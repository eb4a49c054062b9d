#pragma once

namespace lodeline {

/// While one exists, the first Ctrl-C (SIGINT), SIGTERM or SIGHUP asks for a stop instead of ending the
/// program, so that results can be completed; the second one ends it as usual. One at a time.
class StopRequest {
 public:
  StopRequest();
  ~StopRequest();
  StopRequest(const StopRequest&) = delete;
  StopRequest& operator=(const StopRequest&) = delete;

  bool made() const;
};

}  // namespace lodeline

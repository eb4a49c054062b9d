#pragma once

#include <functional>
#include <memory>
#include <string>

namespace lodeline {

/// Serves a page at `/` and a stream of server-sent events at `/events`. The server uses its own threads;
/// senders never wait for a browser.
class LiveServer {
 public:
  /// Maximum number of simultaneous browsers; a further one is asked to retry later.
  static constexpr size_t kMostWatchers = 4;

  /// `port` 0 selects any free port. Throws UsageError where the port is not available.
  LiveServer(const std::string& address, int port, std::string page);
  /// Sends all pending events to all browsers, then ends.
  ~LiveServer();
  LiveServer(const LiveServer&) = delete;
  LiveServer& operator=(const LiveServer&) = delete;

  std::string url() const;
  bool isWatched() const;

  /// Sends one event to every browser. `data` has one line.
  void send(const std::string& event, const std::string& data);
  /// Sends an event that later browsers also receive when they connect. When there are many of these, every
  /// second one is dropped.
  void sendAndKeep(const std::string& event, const std::string& data);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lodeline

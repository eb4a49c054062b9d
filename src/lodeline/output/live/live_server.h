#pragma once

#include <functional>
#include <memory>
#include <string>

namespace lodeline {

/// Gives browsers a page at `/` and a stream of server-sent events at `/events`. All of it happens on threads
/// of its own; whoever sends never waits for a browser, however slow or gone.
class LiveServer {
 public:
  /// Browsers that can watch at a time; another one is told to come back later.
  static constexpr size_t kMostWatchers = 4;

  /// `port` 0 takes any that is free. Throws UsageError where the port cannot be had.
  LiveServer(const std::string& address, int port, std::string page);
  /// Tells all watchers what is still to be told, then ends.
  ~LiveServer();
  LiveServer(const LiveServer&) = delete;
  LiveServer& operator=(const LiveServer&) = delete;

  std::string url() const;
  bool isWatched() const;

  /// One event to every watcher. `data` has one line.
  void send(const std::string& event, const std::string& data);
  /// An event that later watchers are told, too, when they come. When there are many of these, every second
  /// one is forgotten.
  void sendAndKeep(const std::string& event, const std::string& data);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lodeline

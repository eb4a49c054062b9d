#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

namespace lodeline {

/// Pending messages for one browser. The number of texts is bounded: a slow browser loses the oldest, and the
/// sender never waits.
class EventQueue {
 public:
  explicit EventQueue(size_t capacity) : capacity_(capacity) {}

  void push(std::string text);
  /// The oldest text; waits for one. Empty once the queue is closed and has no more texts.
  std::optional<std::string> pop();
  /// Ends the queue: there will be no further push().
  void close();

 private:
  size_t capacity_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::string> texts_;
  bool closed_ = false;
};

}  // namespace lodeline

#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

namespace lodeline {

/// What one browser has yet to be told. Holds a bounded number of texts: a browser that does not keep up
/// loses the oldest, and whoever tells it never waits.
class EventQueue {
 public:
  explicit EventQueue(size_t capacity) : capacity_(capacity) {}

  void push(std::string text);
  /// The oldest text; waits for one. Nothing once the queue is closed and empty.
  std::optional<std::string> pop();
  /// No more will be pushed.
  void close();

 private:
  size_t capacity_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::string> texts_;
  bool closed_ = false;
};

}  // namespace lodeline
